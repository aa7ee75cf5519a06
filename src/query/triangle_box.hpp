// Whether a triangle has a point in a box, decided exactly.
#pragma once

#include <algorithm>

#include "math/box3f.hpp"
#include "math/predicates.hpp"
#include "math/triangle.hpp"

namespace kerf {

/// Both sets closed: touching counts. By the theorem of separating axes for convex bodies (Akenine-Möller
/// 2001, "Fast 3D Triangle-Box Overlap Testing"), each axis an exact predicate on the given coordinates.
inline bool overlaps(const Triangle& triangle, const Box3f& box) {
  const Box3f bounds = bounds_of(triangle);
  if (intersect(bounds, box).empty()) return false;
  if (contains(box, bounds)) return true;
  const Vec3f vertices[3] = {triangle.v0, triangle.v1, triangle.v2};

  // Axes across an edge and a coordinate axis: does the line of the edge, seen along that axis, part the
  // shadow of the box from the shadow of the third vertex?
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    for (int e = 0; e < 3; ++e) {
      const Vec3f &a = vertices[e], &b = vertices[(e + 1) % 3], &c = vertices[(e + 2) % 3];
      const int third = orientation_2d(a[i], a[j], b[i], b[j], c[i], c[j]);
      bool left = false, right = false;
      for (const float x : {box.lower[i], box.upper[i]}) {
        for (const float y : {box.lower[j], box.upper[j]}) {
          const int side = orientation_2d(a[i], a[j], b[i], b[j], x, y);
          left = left || side >= 0;
          right = right || side <= 0;
        }
      }
      if ((third >= 0 && !left) || (third <= 0 && !right)) return false;
    }
  }

  // The normal of the triangle: are all corners of the box on one side of its plane?
  bool above = false, below = false;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f p{corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                  corner & 4 ? box.upper.z : box.lower.z};
    const int side = orientation(p, triangle.v0, triangle.v1, triangle.v2);
    above = above || side >= 0;
    below = below || side <= 0;
  }
  return above && below;
}

}  // namespace kerf
