// Geometric predicates on points with float coordinates, decided exactly: first in double precision with a
// bound on its error, and where that leaves the sign open, without rounding (Shewchuk 1997).
#pragma once

#include <cmath>

#include <kerf/vec.hpp>

#include "math/exact_sum.hpp"

namespace kerf {

inline Vec3d widen(const Vec3f& a) {
  return {a.x, a.y, a.z};
}

/// `a - b`, each component with a relative error of at most 2^-53.
inline Vec3d difference(const Vec3f& a, const Vec3f& b) {
  return {static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y, static_cast<double>(a.z) - b.z};
}

/// A determinant computed in double precision, and a bound on its error.
struct Determinant {
  double value;
  double error;

  /// Bounds the error relative to the sum of the terms' magnitudes. Each term passes at most seven roundings
  /// of 2^-53 (three differences, two products, two sums); Shewchuk's bound for the same expression is (7 +
  /// 56 * 2^-53) * 2^-53. Ten leaves room for the rounding of the bound itself.
  static constexpr double bound = 10.0 / 9007199254740992.0;

  bool certain() const { return std::abs(value) > error; }

  /// Whether the relative error is below 2^-26, so that the quotient of two determinants rounds to the right
  /// float or its neighbour.
  bool precise() const { return std::abs(value) > error * (1 << 26); }
};

/// The determinant of three vectors whose components have relative errors of at most 2^-53.
inline Determinant determinant(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double yz = b.y * c.z, zy = b.z * c.y, zx = b.z * c.x, xz = b.x * c.z, xy = b.x * c.y, yx = b.y * c.x;
  const double size = std::abs(a.x) * (std::abs(yz) + std::abs(zy)) +
                      std::abs(a.y) * (std::abs(zx) + std::abs(xz)) +
                      std::abs(a.z) * (std::abs(xy) + std::abs(yx));
  return {a.x * (yz - zy) + a.y * (zx - xz) + a.z * (xy - yx), Determinant::bound * size};
}

/// Adds `sign` times the determinant of a, b and c.
inline void add_determinant(ExactSum& sum, float sign, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  sum.add_product(sign * a.x, b.y, c.z);
  sum.add_product(-sign * a.x, b.z, c.y);
  sum.add_product(sign * a.y, b.z, c.x);
  sum.add_product(-sign * a.y, b.x, c.z);
  sum.add_product(sign * a.z, b.x, c.y);
  sum.add_product(-sign * a.z, b.y, c.x);
}

/// Adds `t` times the determinant of a, b and c.
inline void add_product_with_determinant(ExactSum& sum, float t, const Vec3f& a, const Vec3f& b,
                                         const Vec3f& c) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum.add_product(t, a[i], b[j], c[k]);
    sum.add_product(-t, a[i], b[k], c[j]);
  }
}

/// det(a - p, b - p, c - p), positive where a, b, c run counter-clockwise as seen from p.
inline ExactSum exact_orientation(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  ExactSum sum;
  add_determinant(sum, 1.0f, a, b, c);
  add_determinant(sum, -1.0f, p, b, c);
  add_determinant(sum, -1.0f, a, p, c);
  add_determinant(sum, -1.0f, a, b, p);
  return sum;
}

inline int orientation(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Determinant estimate = determinant(difference(a, p), difference(b, p), difference(c, p));
  if (estimate.certain()) return estimate.value > 0.0 ? 1 : -1;
  return exact_orientation(p, a, b, c).sign();
}

/// (bx - ax) * (cy - ay) - (by - ay) * (cx - ax): positive where c lies to the left of the line from a to b.
inline int orientation_2d(float ax, float ay, float bx, float by, float cx, float cy) {
  constexpr double bound = 6.0 / 9007199254740992.0;  // Shewchuk's (3 + 16 * 2^-53) * 2^-53, with room
  const double left = (static_cast<double>(bx) - ax) * (static_cast<double>(cy) - ay);
  const double right = (static_cast<double>(by) - ay) * (static_cast<double>(cx) - ax);
  const double estimate = left - right;
  if (std::abs(estimate) > bound * (std::abs(left) + std::abs(right))) return estimate > 0.0 ? 1 : -1;
  ExactSum sum;
  sum.add_product(bx, cy);
  sum.add_product(-bx, ay);
  sum.add_product(-ax, cy);
  sum.add_product(-by, cx);
  sum.add_product(by, ax);
  sum.add_product(ay, cx);
  return sum.sign();
}

/// Whether a, b and c lie on one line, as the vertices of a triangle without area do.
inline bool collinear(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y) == 0 &&
         orientation_2d(a.y, a.z, b.y, b.z, c.y, c.z) == 0 &&
         orientation_2d(a.z, a.x, b.z, b.x, c.z, c.x) == 0;
}

}  // namespace kerf
