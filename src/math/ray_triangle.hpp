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
  double inverse_dz;

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
    inverse_dz = 1.0 / static_cast<double>(d[kz]);
  }
};

/// Makes `hit` the crossing of the ray with `triangle` if that lies in `[t_min, t_max]`; only t, u and v are
/// written.
///
/// What is decided here is exact for the triangle as it stands after the shear, whose vertices are rounded to
/// single precision, each in one way for all the triangles that share it: a ray that meets a closed surface
/// hits a triangle. The weights are near exact, too, so that t is the distance of a point of the triangle
/// that lies within the shear's rounding of the ray, however thin the triangle: t fits the boxes in which the
/// traversal looks for the triangle.
///
/// First come edge functions in single precision. A difference of two rounded products has the sign of the
/// exact one, or is zero: rounding is monotonic. (That would not hold if one product were fused into the
/// difference.) They turn most triangles away. For the others, products of two floats are exact in double
/// precision.
inline bool intersect_triangle(const RayShear& shear, const Vec3f& origin, const Triangle& triangle,
                               float t_min, float t_max, Hit& hit) {
  const Vec3f a = triangle.v0 - origin, b = triangle.v1 - origin, c = triangle.v2 - origin;
  const float ax = a[shear.kx] - shear.sx * a[shear.kz], ay = a[shear.ky] - shear.sy * a[shear.kz];
  const float bx = b[shear.kx] - shear.sx * b[shear.kz], by = b[shear.ky] - shear.sy * b[shear.kz];
  const float cx = c[shear.kx] - shear.sx * c[shear.kz], cy = c[shear.ky] - shear.sy * c[shear.kz];
  const auto signs_differ = [](auto u, auto v, auto w) {
    return (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0);
  };
  if (signs_differ(cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax)) return false;

  const double u = static_cast<double>(cx) * by - static_cast<double>(cy) * bx;
  const double v = static_cast<double>(ax) * cy - static_cast<double>(ay) * cx;
  const double w = static_cast<double>(bx) * ay - static_cast<double>(by) * ax;
  if (signs_differ(u, v, w)) return false;
  const double determinant = u + v + w;
  const double z = u * a[shear.kz] + v * b[shear.kz] + w * c[shear.kz];
  const double inverse = 1.0 / determinant;
  const auto t = static_cast<float>(z * inverse * shear.inverse_dz);
  if (!(t >= t_min && t <= t_max)) return false;  // so is a triangle seen edge-on, whose determinant is 0
  hit.t = t;
  hit.u = static_cast<float>(v * inverse);
  hit.v = static_cast<float>(w * inverse);
  return true;
}

}  // namespace kerf
