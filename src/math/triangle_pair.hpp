// Whether two triangles have a point in common, decided exactly.
#pragma once

#include <algorithm>

#include "math/box3f.hpp"
#include "math/predicates.hpp"
#include "math/triangle.hpp"

namespace kerf {

/// Two of the three coordinates.
struct Projection {
  int i, j;

  int orientation(const Vec3f& a, const Vec3f& b, const Vec3f& c) const {
    return orientation_2d(a[i], a[j], b[i], b[j], c[i], c[j]);
  }
};

/// Whether two closed segments of one plane meet, in a projection in which the plane has an area. A segment
/// may be a point.
inline bool segments_meet(const Projection& seen, const Vec3f& p, const Vec3f& q, const Vec3f& a,
                          const Vec3f& b) {
  const int side_a = seen.orientation(p, q, a), side_b = seen.orientation(p, q, b);
  const int side_p = seen.orientation(a, b, p), side_q = seen.orientation(a, b, q);
  if (side_a != 0 || side_b != 0 || side_p != 0 || side_q != 0)
    return side_a * side_b <= 0 && side_p * side_q <= 0;
  const auto overlap = [&](int axis) {  // all on one line
    return std::max(std::min(p[axis], q[axis]), std::min(a[axis], b[axis])) <=
           std::min(std::max(p[axis], q[axis]), std::max(a[axis], b[axis]));
  };
  return overlap(seen.i) && overlap(seen.j);
}

/// Whether the closed segment from `p` to `q`, which may be a point, meets the triangle, which has an area.
inline bool segment_meets(const Vec3f& p, const Vec3f& q, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const int side_p = orientation(p, a, b, c), side_q = orientation(q, a, b, c);
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) {
    Projection seen{0, 1};
    if (seen.orientation(a, b, c) == 0) seen = {1, 2};
    if (seen.orientation(a, b, c) == 0) seen = {2, 0};
    if (segments_meet(seen, p, q, a, b) || segments_meet(seen, p, q, b, c) || segments_meet(seen, p, q, c, a))
      return true;
    const int sa = seen.orientation(b, c, p), sb = seen.orientation(c, a, p), sc = seen.orientation(a, b, p);
    return (sa > 0 && sb > 0 && sc > 0) || (sa < 0 && sb < 0 && sc < 0);  // the segment lies inside
  }
  const int sa = orientation(p, q, b, c), sb = orientation(p, q, c, a), sc = orientation(p, q, a, b);
  return (sa >= 0 && sb >= 0 && sc >= 0) || (sa <= 0 && sb <= 0 && sc <= 0);
}

/// Whether an edge of `edges` meets `triangle`, which has an area.
inline bool edge_meets(const Triangle& edges, const Triangle& triangle) {
  return segment_meets(edges.v0, edges.v1, triangle) || segment_meets(edges.v1, edges.v2, triangle) ||
         segment_meets(edges.v2, edges.v0, triangle);
}

/// Both closed: touching counts. `first` has an area, `second` may have none. Of two triangles that have a
/// point in common, one has an edge that meets the other.
inline bool triangles_touch(const Triangle& first, const Triangle& second) {
  if (intersect(bounds_of(first), bounds_of(second)).empty()) return false;
  const auto one_side = [](const Triangle& of, const Triangle& t) {
    const auto& [a, b, c] = of;
    const int side = orientation(t.v0, a, b, c);
    return side != 0 && orientation(t.v1, a, b, c) == side && orientation(t.v2, a, b, c) == side;
  };
  if (one_side(first, second) || one_side(second, first)) return false;
  return edge_meets(second, first) || (!is_degenerate(second) && edge_meets(first, second));
}

}  // namespace kerf
