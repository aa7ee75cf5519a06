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

  // Axes perpendicular to an edge and to a coordinate axis: projected along that axis, does the line of the
  // edge separate the box from the third vertex? The third vertex lies on the same side, left or right, of
  // all three edges. The corner of the box that is farthest to that side decides.
  int normal[3];  // signs of the components
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const auto& [v0, v1, v2] = vertices;
    const int third = orientation_2d(v0[i], v0[j], v1[i], v1[j], v2[i], v2[j]);
    normal[(i + 2) % 3] = third;
    for (int e = 0; e < 3; ++e) {
      const Vec3f &a = vertices[e], &b = vertices[(e + 1) % 3];
      const bool up = b[i] > a[i], right = b[j] < a[j];  // where the left of the edge is
      const auto side = [&](bool to_right, bool to_up) {
        return orientation_2d(a[i], a[j], b[i], b[j], to_right ? box.upper[i] : box.lower[i],
                              to_up ? box.upper[j] : box.lower[j]);
      };
      if (third >= 0 && side(right, up) < 0) return false;
      if (third <= 0 && side(!right, !up) > 0) return false;
    }
  }

  // The normal of the triangle: do the corners of the box that are farthest along and against it lie on the
  // same side of its plane?
  Vec3f along, against;
  for (int k = 0; k < 3; ++k) {
    along[k] = normal[k] > 0 ? box.upper[k] : box.lower[k];
    against[k] = normal[k] > 0 ? box.lower[k] : box.upper[k];
  }
  return orientation(against, triangle.v0, triangle.v1, triangle.v2) >= 0 &&
         orientation(along, triangle.v0, triangle.v1, triangle.v2) <= 0;
}

}  // namespace kerf
