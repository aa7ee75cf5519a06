// Watertight ray-triangle intersection (Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection").
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <kerf/ray.hpp>

#include "math/ray_crossing.hpp"
#include "math/triangle.hpp"
#include "math/vec3f.hpp"

namespace kerf {

/// A ray's frame: the axis on which its direction is largest becomes z, and a shear takes the direction to
/// (0, 0, d).
struct RayShear {
  int kx, ky, kz;
  float sx, sy;
  float dz, inverse_dz;

  RayShear() = default;
  explicit RayShear(const Vec3f& direction) {
    const float d[3] = {direction.x, direction.y, direction.z};
    const float ax = std::abs(d[0]), ay = std::abs(d[1]), az = std::abs(d[2]);
    kz = ax > ay ? 0 : 1;
    kz = std::max(ax, ay) > az ? kz : 2;
    const bool negative = d[kz] < 0.0f;
    constexpr std::int8_t next[3] = {1, 2, 0}, after_next[3] = {2, 0, 1};
    kx = (negative ? after_next : next)[kz];  // swapped where that keeps the winding of triangles
    ky = (negative ? next : after_next)[kz];
    sx = d[kx] / d[kz];
    sy = d[ky] / d[kz];
    dz = d[kz];
    inverse_dz = 1.0f / dz;
  }
};

/// A vertex of a triangle in the ray's frame: relative to the origin, and sheared.
struct ShearedCorner {
  float x, y, z;

  ShearedCorner(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
  ShearedCorner(const RayShear& shear, const Vec3f& origin, const Vec3f& vertex) {
    const Vec3f from_origin = vertex - origin;
    z = from_origin[shear.kz];
    x = from_origin[shear.kx] - shear.sx * z;
    y = from_origin[shear.ky] - shear.sy * z;
  }
};

/// a * b - c * d with an error of at most two units in the last place, however much cancels, and thus with
/// the right sign or zero (Kahan's algorithm; Jeannerod, Louvet & Muller 2013, "Further Analysis of Kahan's
/// Algorithm for the Accurate Computation of 2 x 2 Determinants"). No product may leave the range of a float.
inline float difference_of_products(float a, float b, float c, float d) {
  const float cd = c * d;
  return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

/// The range in which single precision is trusted: underflow does not change an edge function noticeably, and
/// nothing overflows.
struct SinglePrecision {
  static constexpr float min_sign = 0x1p-100f;  // of an edge function, for its sign
  static constexpr float min_value = 0x1p-60f;  // for its value, too
  static constexpr float max_value = 0x1p126f;  // of the determinant
};

/// How a ray that passes a triangle within its edges, as they stand after the shear, weighs the corners: by
/// the edge functions opposite to them, all of one sign.
struct Weights {
  double a, b, c;
};

/// The weights in double precision, where products of two floats are exact, so that edges and vertices which
/// the ray meets exactly are told. False if the ray passes outside, or sees the triangle edge-on.
inline bool weigh_exactly(const ShearedCorner& a, const ShearedCorner& b, const ShearedCorner& c,
                          Weights& weights) {
  weights.a = static_cast<double>(c.x) * b.y - static_cast<double>(c.y) * b.x;
  weights.b = static_cast<double>(a.x) * c.y - static_cast<double>(a.y) * c.x;
  weights.c = static_cast<double>(b.x) * a.y - static_cast<double>(b.y) * a.x;
  const auto& [u, v, w] = weights;
  return !((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) && u + v + w != 0;
}

/// The weights in single precision if that is trusted, else `exact`.
inline Weights weigh(const ShearedCorner& a, const ShearedCorner& b, const ShearedCorner& c,
                     const Weights& exact) {
  const float u = difference_of_products(c.x, b.y, c.y, b.x), v = difference_of_products(a.x, c.y, a.y, c.x),
              w = difference_of_products(b.x, a.y, b.y, a.x);
  const float smallest = std::min({u, v, w}), largest = std::max({u, v, w});
  const bool trusted = (smallest > SinglePrecision::min_value || largest < -SinglePrecision::min_value) &&
                       std::abs(u + v + w) < SinglePrecision::max_value;
  return trusted ? Weights{u, v, w} : exact;
}

/// Where a ray hits a triangle that it passes within its edges, after the shear.
///
/// The shear moves corners by roundings, so that a triangle which is seen nearly edge-on may be hit although
/// the ray does not meet it, and its plane only far away. Then the hit is the triangle's point that the
/// weights name: it lies beside the ray. In all other cases it is where the ray crosses the plane.
inline RayCrossing hit_crossing(const Vec3f& o, const Vec3f& d, const Triangle& triangle,
                                const CrossingEstimate& estimate, const RayShear& shear,
                                const ShearedCorner& a, const ShearedCorner& b, const ShearedCorner& c,
                                const Weights& exact) {
  const bool steep = estimate.steep();
  if (steep && estimate.precise()) return estimate.crossing(estimate.height);
  RayCrossing crossing;
  if (cross_exactly(o, d, triangle, crossing)) return crossing;
  if (steep) return estimate.crossing(height_above(o, triangle));
  const int z = shear.kz;
  const Weights weights = weigh(a, b, c, exact);
  const double sum = weights.a + weights.b + weights.c;
  const double height = weights.a * (triangle.v0[z] - o[z]) + weights.b * (triangle.v1[z] - o[z]) +
                        weights.c * (triangle.v2[z] - o[z]);
  return round_crossing(height / sum / shear.dz, weights.b / sum, weights.c / sum);
}

/// Makes `hit` the crossing of the ray with `triangle` if that lies in `[t_min, t_max]`. Only t, u and v are
/// written.
///
/// Which triangles are hit is exact for them as they stand after the shear, whose corners are rounded to
/// single precision, each in one way for all the triangles that share it: a ray that meets a closed surface
/// hits a triangle. The weights are near exact, too, so that they name a point of the triangle that lies
/// within the shear's rounding of the ray, however thin the triangle. Where the hit lies is exact for the
/// triangle as it is given, but for the rounding to floats.
inline bool intersect_triangle(const RayShear& shear, const Vec3f& origin, const Vec3f& direction,
                               const Triangle& triangle, float t_min, float t_max, Hit& hit) {
  const CrossingEstimate estimate = estimate_crossing(origin, direction, triangle);
  // All triangles around a corner that the ray begins at leave here, before anything exact is computed.
  if (estimate.certainly_before(t_min)) return false;
  const ShearedCorner a(shear, origin, triangle.v0), b(shear, origin, triangle.v1),
      c(shear, origin, triangle.v2);
  Weights exact{};
  if (!weigh_exactly(a, b, c, exact)) return false;
  const RayCrossing crossing = hit_crossing(origin, direction, triangle, estimate, shear, a, b, c, exact);
  if (!(crossing.t >= t_min && crossing.t <= t_max)) return false;
  hit.t = crossing.t;
  hit.u = crossing.u;
  hit.v = crossing.v;
  return true;
}

}  // namespace kerf
