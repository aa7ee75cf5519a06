// Where a line crosses a triangle, decided exactly: no tolerance, and every edge belongs to one of its two
// sides.
#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include <kerf/ray.hpp>

#include "math/predicates.hpp"
#include "math/ray_crossing.hpp"
#include "math/triangle.hpp"

namespace kerf {

/// The side on which the line from `o` along `d` passes the edge from `a` to `b`: the sign of det(d, a - o, b
/// - o).
///
/// A line through the edge itself is moved aside by an infinitesimal amount along one axis, then by a still
/// smaller one along another (Edelsbrunner & Mücke 1990, "Simulation of Simplicity"). The moved line is the
/// same for all triangles and meets no edge and no vertex, so that it crosses a closed surface an even number
/// of times. 0 only for an edge that is parallel to the line, which no movement separates.
inline int exact_edge_side(const Vec3f& o, const Vec3f& d, const Vec3f& a, const Vec3f& b) {
  if (const int sign = exact_edge_side_sum(o, d, a, b).sign()) return sign;
  // Moving o by w adds det(d, b - a, w), that is w . (d x (b - a)): here for w = x, then y, then z. The
  // component of the movement along d adds nothing, so that two of the axes are enough to decide; the third
  // does no harm.
  const auto component = [&](int i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    ExactSum cross;
    cross.add_product(d[j], b[k]);
    cross.add_product(-d[j], a[k]);
    cross.add_product(-d[k], b[j]);
    cross.add_product(d[k], a[j]);
    return cross.sign();
  };
  if (const int sign = component(0)) return sign;
  if (const int sign = component(1)) return sign;
  return component(2);
}

/// Whether the whole line crosses `triangle`, whichever way that faces. `o` and `d` must be finite.
inline bool line_crosses(const Vec3f& o, const Vec3f& d, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3d direction = widen(d), ao = difference(a, o), bo = difference(b, o), co = difference(c, o);
  const auto sign = [](const Determinant& w) { return w.certain() ? (w.value > 0.0 ? 1 : -1) : 0; };
  int sa = sign(determinant(direction, bo, co)), sb = sign(determinant(direction, co, ao)),
      sc = sign(determinant(direction, ao, bo));
  if (sa * sb < 0 || sb * sc < 0 || sc * sa < 0) return false;
  if (sa == 0) sa = exact_edge_side(o, d, b, c);
  if (sb == 0) sb = exact_edge_side(o, d, c, a);
  if (sc == 0) sc = exact_edge_side(o, d, a, b);
  return sa != 0 && sa == sb && sb == sc;
}

/// Whether the ray crosses `triangle` within its range, and where. The range is that of the rounded t.
inline bool ray_crosses(const Ray& ray, const Triangle& triangle, RayCrossing& crossing) {
  if (!line_crosses(ray.origin, ray.direction, triangle)) return false;
  crossing = crossing_of(ray.origin, ray.direction, triangle);
  return crossing.t >= ray.t_min && crossing.t <= ray.t_max;
}

/// Whether `p` lies on the triangle, its edges and vertices included.
inline bool lies_on(const Vec3f& p, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  if (orientation(p, a, b, c) != 0) return false;
  // They lie in one plane. At least one of the projections of the triangle onto the coordinate planes has an
  // area, and a point of that projection is a point of the triangle.
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (orientation_2d(a[i], a[j], b[i], b[j], c[i], c[j]) == 0) continue;
    const int sc = orientation_2d(a[i], a[j], b[i], b[j], p[i], p[j]);
    const int sa = orientation_2d(b[i], b[j], c[i], c[j], p[i], p[j]);
    const int sb = orientation_2d(c[i], c[j], a[i], a[j], p[i], p[j]);
    return (sa >= 0 && sb >= 0 && sc >= 0) || (sa <= 0 && sb <= 0 && sc <= 0);
  }
  return false;
}

}  // namespace kerf
