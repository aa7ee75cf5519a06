// Watertight ray-triangle intersection (Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection").
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <kerf/ray.hpp>

#include "math/triangle.hpp"
#include "math/vec3f.hpp"

namespace kerf {

/// A ray's frame: the axis on which its direction is largest becomes z, and a shear takes the direction to
/// (0, 0, d).
struct RayShear {
  int kx, ky, kz;
  float sx, sy;
  float dz, inverse_dz;

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
  static constexpr float max_value = 0x1p126f;  // of the determinant and of t
};

/// `intersect_triangle` where single precision does not suffice. Products of two floats are exact in double
/// precision, so that a ray that meets an edge or a vertex exactly is recognised.
inline bool intersect_exactly(const ShearedCorner& a, const ShearedCorner& b, const ShearedCorner& c,
                              float dz, float t_min, float t_max, Hit& hit) {
  const double u = static_cast<double>(c.x) * b.y - static_cast<double>(c.y) * b.x;
  const double v = static_cast<double>(a.x) * c.y - static_cast<double>(a.y) * c.x;
  const double w = static_cast<double>(b.x) * a.y - static_cast<double>(b.y) * a.x;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double inverse = 1.0 / (u + v + w);
  const double z = u * a.z + v * b.z + w * c.z;
  const auto t = static_cast<float>(z * inverse / dz);
  if (!(t >= t_min && t <= t_max)) return false;  // true of a triangle seen edge-on: its determinant is 0
  hit.t = t;
  hit.u = static_cast<float>(v * inverse);
  hit.v = static_cast<float>(w * inverse);
  return true;
}

/// Makes `hit` the crossing of the ray with `triangle` if that lies in `[t_min, t_max]`. Only t, u and v are
/// written.
///
/// The decision is exact for the sheared triangle. The shear rounds each vertex to single precision in the
/// same way for all triangles that share it, so that a ray that meets a closed surface hits a triangle. The
/// weights are nearly exact, too: however thin the triangle, t is the distance of one of its points that lies
/// within the shear's rounding of the ray. So t fits the boxes in which traversal finds the triangle
/// (`RayBoxes` has the sum).
inline bool intersect_triangle(const RayShear& shear, const Vec3f& origin, const Triangle& triangle,
                               float t_min, float t_max, Hit& hit) {
  const ShearedCorner a(shear, origin, triangle.v0), b(shear, origin, triangle.v1),
      c(shear, origin, triangle.v2);
  const float u = difference_of_products(c.x, b.y, c.y, b.x), v = difference_of_products(a.x, c.y, a.y, c.x),
              w = difference_of_products(b.x, a.y, b.y, a.x);
  const float smallest = std::min({u, v, w}), largest = std::max({u, v, w});
  if (smallest < -SinglePrecision::min_sign && largest > SinglePrecision::min_sign) return false;

  const float determinant = u + v + w;
  const float inverse = 1.0f / determinant;
  const float t = (u * a.z + v * b.z + w * c.z) * inverse * shear.inverse_dz;
  const bool trusted = (smallest > SinglePrecision::min_value || largest < -SinglePrecision::min_value) &&
                       std::abs(determinant) < SinglePrecision::max_value &&
                       std::abs(t) < SinglePrecision::max_value;
  if (!trusted) return intersect_exactly(a, b, c, shear.dz, t_min, t_max, hit);
  if (!(t >= t_min && t <= t_max)) return false;
  hit.t = t;
  hit.u = v * inverse;
  hit.v = w * inverse;
  return true;
}

}  // namespace kerf
