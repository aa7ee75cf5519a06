// The library's geometric predicates once more, operation by operation: decided in double precision with a
// bound on its error, and where that leaves a sign open, without rounding (Shewchuk 1997, "Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates").
#pragma once

#include <kerf/vec.hpp>

#include "arithmetic.hpp"

namespace kerf::cuda {

struct Vec3d {
  double x, y, z;
};
KERF_CUDA_INLINE Vec3d widen(const Vec3f& a) {
  return {a.x, a.y, a.z};
}
KERF_CUDA_INLINE Vec3d difference(const Vec3f& a, const Vec3f& b) {
  return {static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y, static_cast<double>(a.z) - b.z};
}
KERF_CUDA_INLINE Vec3d operator-(const Vec3d& a, const Vec3d& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
KERF_CUDA_INLINE double dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
KERF_CUDA_INLINE Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
KERF_CUDA_INLINE double largest_component(const Vec3d& a) {
  return standard_max(standard_max(absolute(a.x), absolute(a.y)), absolute(a.z));
}
// `Vec3f::operator[]` is code of the host alone.
KERF_CUDA_INLINE float component(const Vec3f& a, int axis) {
  return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

struct Corners {
  Vec3f a, b, c;
};

/// A sum of doubles, kept as parts that do not overlap, smallest first, so that no bit is lost.
class ExactSum {
 public:
  /// The most terms that a predicate needs: 24 products of three floats, each of two parts.
  static constexpr int capacity = 48;

  KERF_CUDA_BOTH ExactSum() : count_(0) {}

  KERF_CUDA_BOTH void add(double term) {
    double carry = term;
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const double sum = carry + parts_[i];
      const double part = sum - carry;
      const double error = (carry - (sum - part)) + (parts_[i] - part);
      if (error != 0.0) parts_[kept++] = error;
      carry = sum;
    }
    if (carry != 0.0) parts_[kept++] = carry;
    count_ = kept;
  }
  KERF_CUDA_BOTH void add_product(float x, float y) { add(static_cast<double>(x) * y); }
  KERF_CUDA_BOTH void add_product(float x, float y, float z) {
    constexpr double splitter = (1 << 27) + 1;
    const double product = static_cast<double>(x) * y;
    const double scaled = splitter * product;
    const double high = scaled - (scaled - product);
    add(high * z);
    add((product - high) * z);
  }
  /// -1, 0 or 1.
  KERF_CUDA_BOTH int sign() const { return count_ == 0 ? 0 : parts_[count_ - 1] > 0.0 ? 1 : -1; }

  /// The sum, rounded.
  KERF_CUDA_BOTH double value() const {
    double sum = 0.0;
    for (int i = 0; i < count_; ++i) sum += parts_[i];
    return sum;
  }

 private:
  double parts_[capacity];
  int count_;
};

/// A determinant computed in double precision, and a bound on its error.
struct Determinant {
  double value, error;

  static constexpr double bound = 10.0 / 9007199254740992.0;

  KERF_CUDA_INLINE bool certain() const { return absolute(value) > error; }
  KERF_CUDA_INLINE bool precise() const { return absolute(value) > error * (1 << 26); }
};

KERF_CUDA_INLINE Determinant determinant(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double yz = b.y * c.z, zy = b.z * c.y, zx = b.z * c.x, xz = b.x * c.z, xy = b.x * c.y, yx = b.y * c.x;
  const double size = absolute(a.x) * (absolute(yz) + absolute(zy)) +
                      absolute(a.y) * (absolute(zx) + absolute(xz)) +
                      absolute(a.z) * (absolute(xy) + absolute(yx));
  return {a.x * (yz - zy) + a.y * (zx - xz) + a.z * (xy - yx), Determinant::bound * size};
}

KERF_CUDA_BOTH inline void add_determinant(ExactSum& sum, float sign, const Vec3f& a, const Vec3f& b,
                                           const Vec3f& c) {
  sum.add_product(sign * a.x, b.y, c.z);
  sum.add_product(-sign * a.x, b.z, c.y);
  sum.add_product(sign * a.y, b.z, c.x);
  sum.add_product(-sign * a.y, b.x, c.z);
  sum.add_product(sign * a.z, b.x, c.y);
  sum.add_product(-sign * a.z, b.y, c.x);
}
/// Adds det(d, a - o, b - o).
KERF_CUDA_BOTH inline void add_edge_side(ExactSum& sum, const Vec3f& o, const Vec3f& d, const Vec3f& a,
                                         const Vec3f& b) {
  add_determinant(sum, 1.0f, d, a, b);
  add_determinant(sum, -1.0f, d, a, o);
  add_determinant(sum, -1.0f, d, o, b);
}
/// Adds det(a - p, b - p, c - p).
KERF_CUDA_BOTH inline void add_orientation(ExactSum& sum, const Vec3f& p, const Vec3f& a, const Vec3f& b,
                                           const Vec3f& c) {
  add_determinant(sum, 1.0f, a, b, c);
  add_determinant(sum, -1.0f, p, b, c);
  add_determinant(sum, -1.0f, a, p, c);
  add_determinant(sum, -1.0f, a, b, p);
}

// What follows in exact arithmetic is called seldom: out of line, with everything by value.
KERF_CUDA_NOINLINE int exact_orientation_sign(Vec3f p, Vec3f a, Vec3f b, Vec3f c) {
  ExactSum sum;
  add_orientation(sum, p, a, b, c);
  return sum.sign();
}
KERF_CUDA_NOINLINE double exact_orientation_value(Vec3f p, Vec3f a, Vec3f b, Vec3f c) {
  ExactSum sum;
  add_orientation(sum, p, a, b, c);
  return sum.value();
}

/// The sign of det(a - p, b - p, c - p): positive where a, b, c run counter-clockwise as seen from p.
KERF_CUDA_BOTH inline int orientation(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Determinant estimate = determinant(difference(a, p), difference(b, p), difference(c, p));
  if (estimate.certain()) return estimate.value > 0.0 ? 1 : -1;
  return exact_orientation_sign(p, a, b, c);
}

KERF_CUDA_NOINLINE int exact_orientation_2d(float ax, float ay, float bx, float by, float cx, float cy) {
  ExactSum sum;
  sum.add_product(bx, cy);
  sum.add_product(-bx, ay);
  sum.add_product(-ax, cy);
  sum.add_product(-by, cx);
  sum.add_product(by, ax);
  sum.add_product(ay, cx);
  return sum.sign();
}
/// The sign of (bx - ax) * (cy - ay) - (by - ay) * (cx - ax).
KERF_CUDA_BOTH inline int orientation_2d(float ax, float ay, float bx, float by, float cx, float cy) {
  constexpr double bound = 6.0 / 9007199254740992.0;
  const double left = (static_cast<double>(bx) - ax) * (static_cast<double>(cy) - ay);
  const double right = (static_cast<double>(by) - ay) * (static_cast<double>(cx) - ax);
  const double estimate = left - right;
  if (absolute(estimate) > bound * (absolute(left) + absolute(right))) return estimate > 0.0 ? 1 : -1;
  return exact_orientation_2d(ax, ay, bx, by, cx, cy);
}

/// Whether the corners are in one line.
KERF_CUDA_BOTH inline bool is_degenerate(const Corners& t) {
  return orientation_2d(t.a.x, t.a.y, t.b.x, t.b.y, t.c.x, t.c.y) == 0 &&
         orientation_2d(t.a.y, t.a.z, t.b.y, t.b.z, t.c.y, t.c.z) == 0 &&
         orientation_2d(t.a.z, t.a.x, t.b.z, t.b.x, t.c.z, t.c.x) == 0;
}

/// Whether `p` lies on the triangle, its edges and corners included.
KERF_CUDA_BOTH inline bool lies_on(const Vec3f& p, const Corners& triangle) {
  const Vec3f &a = triangle.a, &b = triangle.b, &c = triangle.c;
  if (orientation(p, a, b, c) != 0) return false;
  // In one plane: of its three shadows on the coordinate planes at least one keeps an area. A point inside
  // that shadow is inside the triangle.
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const float ai = component(a, i), aj = component(a, j), bi = component(b, i), bj = component(b, j),
                ci = component(c, i), cj = component(c, j), pi = component(p, i), pj = component(p, j);
    if (orientation_2d(ai, aj, bi, bj, ci, cj) == 0) continue;
    const int sc = orientation_2d(ai, aj, bi, bj, pi, pj);
    const int sa = orientation_2d(bi, bj, ci, cj, pi, pj);
    const int sb = orientation_2d(ci, cj, ai, aj, pi, pj);
    return (sa >= 0 && sb >= 0 && sc >= 0) || (sa <= 0 && sb <= 0 && sc <= 0);
  }
  return false;
}

}  // namespace kerf::cuda
