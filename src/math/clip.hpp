// Chopping triangles at axis-aligned planes, conservatively: rounding never loses a point of a triangle.
#pragma once

#include <cmath>
#include <limits>

#include "math/triangle.hpp"

namespace kerf {

/// Rounding in `chop` moves a computed crossing by less than this fraction of the larger coordinate of its
/// edge's ends. With u = 2^-24: two differences and a quotient put a relative error of 3u on the edge's
/// parameter; the third difference and the product add 2u, all of a length of at most twice the larger
/// coordinate; the sum adds u. That is 11u; the next power of two is taken.
inline constexpr float chop_rounding = 16.0f * 0.5f * std::numeric_limits<float>::epsilon();

/// The boxes of the parts of a reference on both sides of a plane. At most one of them is empty.
struct ChoppedBoxes {
  Box3f left, right;
};

/// Chops the part of `triangle` inside `box` at `plane` on `axis`. Every point of the triangle in `box` lies
/// in `left` or in `right`, and points on the plane lie in both. As in Stich et al. 2009, section 4.4,
/// vertices grow the box of their side, and edges that cross the plane grow both. Here each crossing is
/// widened by what rounding may have moved it. Coordinates must be below a quarter of the largest float.
inline ChoppedBoxes chop(const Triangle& triangle, const Box3f& box, int axis, float plane) {
  ChoppedBoxes parts;
  const Vec3f corners[3] = {triangle.v0, triangle.v1, triangle.v2};
  for (int i = 0; i < 3; ++i) {
    const Vec3f& a = corners[i];
    const Vec3f& b = corners[(i + 1) % 3];
    if (a[axis] <= plane) parts.left = merge(parts.left, a);
    if (a[axis] >= plane) parts.right = merge(parts.right, a);
    if ((a[axis] < plane && plane < b[axis]) || (b[axis] < plane && plane < a[axis])) {
      const float t = (plane - a[axis]) / (b[axis] - a[axis]);
      Box3f crossing;
      for (int k = 0; k < 3; ++k) {
        const float at = a[k] + t * (b[k] - a[k]);
        const float margin = chop_rounding * std::max(std::abs(a[k]), std::abs(b[k])) +
                             std::numeric_limits<float>::min();  // products may have underflowed
        crossing.lower[k] = std::max(at - margin, std::min(a[k], b[k]));
        crossing.upper[k] = std::min(at + margin, std::max(a[k], b[k]));
      }
      parts.left = merge(parts.left, crossing);
      parts.right = merge(parts.right, crossing);
    }
  }
  parts.left.upper[axis] = std::min(parts.left.upper[axis], plane);
  parts.right.lower[axis] = std::max(parts.right.lower[axis], plane);
  parts.left = intersect(parts.left, box);
  parts.right = intersect(parts.right, box);
  return parts;
}

}  // namespace kerf
