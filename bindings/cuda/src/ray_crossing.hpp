// Where a ray crosses a triangle that it hits: t, u and v as the exact values round. The library's
// `ray_crossing.hpp` once more, operation by operation.
#pragma once

#include <cfloat>

#include "predicates.hpp"

namespace kerf::cuda {

/// At `(1 - u - v) * v0 + u * v1 + v * v2`, in lengths of the direction from the origin.
struct RayCrossing {
  float t, u, v;
};

KERF_CUDA_INLINE double clamped(double x, double low, double high) {
  return x < low ? low : high < x ? high : x;
}

/// `t` as a float, its sign kept: what is too small for a float becomes the smallest one, what is too large
/// the largest.
KERF_CUDA_INLINE float round_distance(double t) {
  const auto rounded =
      static_cast<float>(clamped(t, -static_cast<double>(FLT_MAX), static_cast<double>(FLT_MAX)));
  if (rounded == 0.0f && t != 0.0) return t < 0.0 ? -0x1p-149f : 0x1p-149f;
  return rounded + 0.0f;
}

/// The crossing from t and from weights of the second and the third corner, which rounding may have moved
/// outside.
KERF_CUDA_INLINE RayCrossing round_crossing(double t, double u, double v) {
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) {
    u = clamped(u, 0.0, 1.0);
    v = clamped(v, 0.0, 1.0);
    const double sum = standard_max(u + v, 1.0);
    u /= sum;
    v /= sum;
  }
  return {round_distance(t), static_cast<float>(u), static_cast<float>(v)};
}

/// The crossing in double precision.
struct CrossingEstimate {
  double height, slope;
  double u, v;       ///< times the slope
  double direction;  ///< the largest component of d
  double corner;     ///< the largest component of p
  double edges;      ///< the largest components of e and of f, multiplied
  double normal;     ///< the largest component of n

  static constexpr double min_slope = 1.0 / 8, min_precise = 0x1p-21;

  KERF_CUDA_INLINE bool steep() const {
    return absolute(slope) >= min_slope * direction * normal &&
           normal >= (1.0 / min_slope) * min_precise * edges;
  }
  KERF_CUDA_INLINE bool precise() const { return absolute(height) >= min_precise * corner * edges; }
  KERF_CUDA_INLINE RayCrossing crossing(double better_height) const {
    return round_crossing(better_height / slope, u / slope, v / slope);
  }
};

KERF_CUDA_INLINE CrossingEstimate estimate_crossing(const Vec3f& o, const Vec3f& d, const Corners& triangle) {
  const Vec3d e = difference(triangle.b, triangle.a), f = difference(triangle.c, triangle.a);
  const Vec3d p = difference(triangle.a, o), direction = widen(d);
  const Vec3d n = cross(e, f), r = cross(direction, p);
  return {dot(p, n),
          dot(direction, n),
          -dot(r, f),
          dot(r, e),
          largest_component(direction),
          largest_component(p),
          largest_component(e) * largest_component(f),
          largest_component(n)};
}

KERF_CUDA_NOINLINE double exact_edge_value(Vec3f o, Vec3f d, Vec3f a, Vec3f b) {
  ExactSum sum;
  add_edge_side(sum, o, d, a, b);
  return sum.value();
}
/// det(d, a - o, b - o), exact in its sign and to a relative error of 2^-26.
KERF_CUDA_BOTH inline double edge_side(const Vec3f& o, const Vec3f& d, const Vec3f& a, const Vec3f& b) {
  const Determinant estimate = determinant(widen(d), difference(a, o), difference(b, o));
  return estimate.precise() ? estimate.value : exact_edge_value(o, d, a, b);
}

/// det(a - o, b - o, c - o), exact in its sign and to a relative error of 2^-26. Seen from the corner nearest
/// to `o`.
KERF_CUDA_BOTH inline double height_above(const Vec3f& o, const Corners& triangle) {
  const double to_a = largest_component(difference(triangle.a, o)),
               to_b = largest_component(difference(triangle.b, o)),
               to_c = largest_component(difference(triangle.c, o));
  Corners t = triangle;
  if (to_b < to_a) t = {triangle.b, triangle.c, triangle.a};
  if (to_c < standard_min(to_a, to_b)) t = {triangle.c, triangle.a, triangle.b};
  const Determinant estimate = determinant(difference(t.a, o), difference(t.b, t.a), difference(t.c, t.a));
  return estimate.precise() || estimate.error == 0.0 ? estimate.value
                                                     : exact_orientation_value(o, t.a, t.b, t.c);
}

/// The crossing where double precision does not suffice; false if the line does not meet the triangle.
KERF_CUDA_BOTH inline bool cross_exactly(const Vec3f& o, const Vec3f& d, const Corners& triangle,
                                         RayCrossing& found) {
  const Vec3f &a = triangle.a, &b = triangle.b, &c = triangle.c;
  const double u = edge_side(o, d, b, c), v = edge_side(o, d, c, a), w = edge_side(o, d, a, b);
  const double low = standard_min(standard_min(u, v), w), high = standard_max(standard_max(u, v), w);
  if ((low < 0.0 && high > 0.0) || (low == 0.0 && high == 0.0)) return false;
  const double slope = u + v + w;
  found = round_crossing(height_above(o, triangle) / slope, v / slope, w / slope);
  return true;
}
KERF_CUDA_NOINLINE RayCrossing exact_crossing_of(Vec3f o, Vec3f d, Corners triangle) {
  RayCrossing crossing{0.0f, 0.0f, 0.0f};
  cross_exactly(o, d, triangle, crossing);
  return crossing;
}

/// The crossing of a line that meets the triangle.
KERF_CUDA_INLINE RayCrossing crossing_of(const Vec3f& o, const Vec3f& d, const Corners& triangle) {
  const CrossingEstimate estimate = estimate_crossing(o, d, triangle);
  if (estimate.steep() && estimate.precise()) return estimate.crossing(estimate.height);
  return exact_crossing_of(o, d, triangle);
}

}  // namespace kerf::cuda
