// Where a ray crosses a triangle that it hits: t, u and v as the exact values round, however large the
// triangle and however near its plane the ray begins. Every call that reports a hit computes them here.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "math/predicates.hpp"
#include "math/triangle.hpp"

namespace kerf {

/// At `(1 - u - v) * v0 + u * v1 + v * v2`, in lengths of the direction from the origin.
struct RayCrossing {
  float t, u, v;
};

inline double largest_component(const Vec3d& a) {
  return std::max(std::max(std::abs(a.x), std::abs(a.y)), std::abs(a.z));
}
inline Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// `t` as a float, its sign kept: what is too small for a float becomes the smallest one, what is too large
/// the largest.
inline float round_distance(double t) {
  constexpr double largest = std::numeric_limits<float>::max();
  constexpr float smallest = std::numeric_limits<float>::denorm_min();
  const auto rounded = static_cast<float>(std::clamp(t, -largest, largest));
  if (rounded == 0.0f && t != 0.0) return t < 0.0 ? -smallest : smallest;
  return rounded + 0.0f;
}

/// The crossing from t and from weights of the second and the third corner, which rounding may have moved
/// outside.
inline RayCrossing round_crossing(double t, double u, double v) {
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) {
    u = std::clamp(u, 0.0, 1.0);
    v = std::clamp(v, 0.0, 1.0);
    const double sum = std::max(u + v, 1.0);
    u /= sum;
    v /= sum;
  }
  return {round_distance(t), static_cast<float>(u), static_cast<float>(v)};
}

/// The crossing in double precision. With e = b - a, f = c - a, the normal n = e x f and p = a - o,
///
///     t = p . n / (d . n)      u = - (d x p) . f / (d . n)      v = (d x p) . e / (d . n)
struct CrossingEstimate {
  double height;     ///< p . n
  double slope;      ///< d . n
  double u, v;       ///< times the slope
  double direction;  ///< the largest component of d
  double corner;     ///< the largest component of p
  double edges;      ///< the largest components of e and of f, multiplied
  double normal;     ///< the largest component of n

  /// The least slope, in largest components of d and n, of a ray that is called steep: one for which a point
  /// of the plane that moves across the ray by 1 along each axis moves along it by no more than 24.
  static constexpr double min_slope = 1.0 / 8;

  /// Height and slope are sums of six products of three differences with at most nine roundings of 2^-53 on
  /// each: their errors are below 2^-47 times `corner * edges` and the same with d. What is larger by 2^26
  /// has a relative error of at most 2^-26.
  static constexpr double max_error = 0x1p-47;
  static constexpr double min_precise = max_error * (1 << 26);

  bool steep() const {
    return std::abs(slope) >= min_slope * direction * normal &&
           normal >= (1.0 / min_slope) * min_precise * edges;
  }

  /// Whether, if it is steep, t rounds to the right float or to its neighbour.
  bool precise() const { return std::abs(height) >= min_precise * corner * edges; }

  /// With a better height, if need be.
  RayCrossing crossing(double better_height) const {
    return round_crossing(better_height / slope, u / slope, v / slope);
  }

  /// Whether the ray certainly crosses the plane before `t`, if it is steep. False says nothing.
  bool certainly_before(float t) const {
    return steep() &&
           std::abs(height) + max_error * corner * edges < 0.999 * static_cast<double>(t) * std::abs(slope);
  }
};

inline CrossingEstimate estimate_crossing(const Vec3f& o, const Vec3f& d, const Triangle& triangle) {
  const Vec3d e = difference(triangle.v1, triangle.v0), f = difference(triangle.v2, triangle.v0);
  const Vec3d p = difference(triangle.v0, o), direction = widen(d);
  const Vec3d n = cross(e, f), r = cross(direction, p);
  return {.height = dot(p, n),
          .slope = dot(direction, n),
          .u = -dot(r, f),
          .v = dot(r, e),
          .direction = largest_component(direction),
          .corner = largest_component(p),
          .edges = largest_component(e) * largest_component(f),
          .normal = largest_component(n)};
}

/// det(d, a - o, b - o) without rounding.
inline ExactSum exact_edge_side_sum(const Vec3f& o, const Vec3f& d, const Vec3f& a, const Vec3f& b) {
  ExactSum sum;
  add_determinant(sum, 1.0f, d, a, b);
  add_determinant(sum, -1.0f, d, a, o);
  add_determinant(sum, -1.0f, d, o, b);
  return sum;
}

/// The side on which the line from `o` along `d` passes the edge from `a` to `b`: det(d, a - o, b - o), exact
/// in its sign and to a relative error of 2^-26.
inline double edge_side(const Vec3f& o, const Vec3f& d, const Vec3f& a, const Vec3f& b) {
  const Determinant estimate = determinant(widen(d), difference(a, o), difference(b, o));
  if (estimate.precise()) return estimate.value;
  return exact_edge_side_sum(o, d, a, b).value();
}

/// det(a - o, b - o, c - o), exact in its sign and to a relative error of 2^-26: the distance of `o` from the
/// plane. Seen from the corner nearest to `o`, where least cancels.
inline double height_above(const Vec3f& o, const Triangle& triangle) {
  const Vec3f corners[3] = {triangle.v0, triangle.v1, triangle.v2};
  int nearest = 0;
  double min_distance = largest_component(difference(corners[0], o));
  for (int i = 1; i < 3; ++i) {
    const double distance = largest_component(difference(corners[i], o));
    if (distance < min_distance) {
      min_distance = distance;
      nearest = i;
    }
  }
  const Vec3f &a = corners[nearest], &b = corners[(nearest + 1) % 3], &c = corners[(nearest + 2) % 3];
  const Determinant estimate = determinant(difference(a, o), difference(b, a), difference(c, a));
  return estimate.precise() || estimate.error == 0.0 ? estimate.value : exact_orientation(o, a, b, c).value();
}

/// The crossing where double precision does not suffice, in three sides and a height that are exact in their
/// signs. If the line does not meet the triangle, `found` is left alone.
inline bool cross_exactly(const Vec3f& o, const Vec3f& d, const Triangle& triangle, RayCrossing& found) {
  const auto& [a, b, c] = triangle;
  const double sides[3] = {edge_side(o, d, b, c), edge_side(o, d, c, a), edge_side(o, d, a, b)};
  const auto [least, greatest] = std::minmax({sides[0], sides[1], sides[2]});
  if ((least < 0.0 && greatest > 0.0) || (least == 0.0 && greatest == 0.0))
    return false;  // outside; in the plane
  const double slope = sides[0] + sides[1] + sides[2];
  found = round_crossing(height_above(o, triangle) / slope, sides[1] / slope, sides[2] / slope);
  return true;
}

/// The crossing of a line that meets the triangle.
inline RayCrossing crossing_of(const Vec3f& o, const Vec3f& d, const Triangle& triangle) {
  const CrossingEstimate estimate = estimate_crossing(o, d, triangle);
  if (estimate.steep() && estimate.precise()) return estimate.crossing(estimate.height);
  RayCrossing crossing{};
  cross_exactly(o, d, triangle, crossing);
  return crossing;
}

}  // namespace kerf
