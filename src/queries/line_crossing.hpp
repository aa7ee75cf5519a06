// Where a line crosses a triangle, decided exactly: no tolerance, and every edge belongs to one of its two
// sides.
#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include <kerf/ray.hpp>

#include "math/predicates.hpp"
#include "math/triangle.hpp"

namespace kerf {

/// At `(1 - u - v) * v0 + u * v1 + v * v2`, in lengths of the direction from the origin. The relative error
/// of `t` is below 2^-24, and its sign is exact.
struct LineCrossing {
  double t, u, v;
};

/// The side on which the line from `o` along `d` passes the edge from `a` to `b`: the sign of det(d, a - o, b
/// - o).
///
/// A line through the edge itself is moved aside by an infinitesimal amount along one axis, then by a still
/// smaller one along another (Edelsbrunner & Mücke 1990, "Simulation of Simplicity"). The moved line is the
/// same for all triangles and meets no edge and no vertex, so that it crosses a closed surface an even number
/// of times. 0 only for an edge that is parallel to the line, which no movement separates.
inline int exact_edge_side(const Vec3f& o, const Vec3f& d, const Vec3f& a, const Vec3f& b) {
  ExactSum sum;
  add_determinant(sum, 1.0f, d, a, b);
  add_determinant(sum, -1.0f, d, a, o);
  add_determinant(sum, -1.0f, d, o, b);
  if (const int sign = sum.sign()) return sign;
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

/// The crossing of the whole line with `triangle`, whichever way that faces. `o` and `d` must be finite.
inline std::optional<LineCrossing> cross_line(const Vec3f& o, const Vec3f& d, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3d direction = widen(d), ao = difference(a, o), bo = difference(b, o), co = difference(c, o);
  const Determinant wa = determinant(direction, bo, co);
  const Determinant wb = determinant(direction, co, ao);
  const Determinant wc = determinant(direction, ao, bo);

  const auto sign = [](const Determinant& w) { return w.certain() ? (w.value > 0.0 ? 1 : -1) : 0; };
  int sa = sign(wa), sb = sign(wb), sc = sign(wc);
  if (sa * sb < 0 || sb * sc < 0 || sc * sa < 0) return std::nullopt;
  if (sa == 0) sa = exact_edge_side(o, d, b, c);
  if (sb == 0) sb = exact_edge_side(o, d, c, a);
  if (sc == 0) sc = exact_edge_side(o, d, a, b);
  if (sa == 0 || sa != sb || sb != sc) return std::nullopt;

  // The three have the same sign, so that their sum is as precise as they are. det(ao, bo, co) is the sum
  // times t.
  const Determinant height = determinant(ao, bo, co);
  const Determinant total{wa.value + wb.value + wc.value, 2.0 * (wa.error + wb.error + wc.error)};
  if (height.precise() && total.precise()) {
    return LineCrossing{height.value / total.value, wb.value / total.value, wc.value / total.value};
  }
  const auto exact = [&](const Vec3f& p, const Vec3f& q) {
    ExactSum sum;
    add_determinant(sum, 1.0f, d, p, q);
    add_determinant(sum, -1.0f, d, p, o);
    add_determinant(sum, -1.0f, d, o, q);
    return sum.value();
  };
  const double ea = exact(b, c), eb = exact(c, a), ec = exact(a, b);
  const double sum = ea + eb + ec;  // not 0: for a line in the plane of the triangle the three sides differ
  return LineCrossing{exact_orientation(o, a, b, c).value() / sum, eb / sum, ec / sum};
}

/// Whether a crossing comes before `t` (-1), there (0) or behind it (1), exactly.
inline int order_against(const LineCrossing& crossing, float t, const Vec3f& o, const Vec3f& d,
                         const Triangle& triangle) {
  if (std::abs(crossing.t - t) > 0x1p-24 * std::abs(crossing.t)) return crossing.t < t ? -1 : 1;
  // As in `cross_line`: height / total against t.
  const auto& [a, b, c] = triangle;
  ExactSum total, difference = exact_orientation(o, a, b, c);
  for (const auto& [p, q] : {std::pair(b, c), std::pair(c, a), std::pair(a, b)}) {
    add_determinant(total, 1.0f, d, p, q);
    add_product_with_determinant(difference, -t, d, p, q);
  }
  return difference.sign() * total.sign();
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
