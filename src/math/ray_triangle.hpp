// Watertight ray-triangle intersection (Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection").
#pragma once

#include <cmath>
#include <utility>

#include <kerf/ray.hpp>

#include "math/vec3f.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// A ray's frame: the axis on which its direction is largest becomes z, and a shear takes the direction to (0, 0, 1).
struct RayShear {
  int kx, ky, kz;
  float sx, sy, sz;

  explicit RayShear(const Vec3f& direction) {
    const float ax = std::abs(direction.x), ay = std::abs(direction.y), az = std::abs(direction.z);
    kz = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    if (direction[kz] < 0.0f) std::swap(kx, ky);  // keeps the winding of triangles
    sx = direction[kx] / direction[kz];
    sy = direction[ky] / direction[kz];
    sz = 1.0f / direction[kz];
  }
};

/// Makes `hit` the crossing of the ray with `triangle` if that lies in `[t_min, t_max]`; only t, u and v are written.
///
/// The edge functions are differences of two rounded products, so that swapping an edge's ends flips the sign and
/// nothing else: this file must be compiled without contraction to fused multiply-add.
inline bool intersect_triangle(const RayShear& shear, const Vec3f& origin, const Triangle& triangle, float t_min,
                               float t_max, Hit& hit) {
  const Vec3f a = triangle.v0 - origin, b = triangle.v1 - origin, c = triangle.v2 - origin;
  const float ax = a[shear.kx] - shear.sx * a[shear.kz], ay = a[shear.ky] - shear.sy * a[shear.kz];
  const float bx = b[shear.kx] - shear.sx * b[shear.kz], by = b[shear.ky] - shear.sy * b[shear.kz];
  const float cx = c[shear.kx] - shear.sx * c[shear.kz], cy = c[shear.ky] - shear.sy * c[shear.kz];

  float u = cx * by - cy * bx;
  float v = ax * cy - ay * cx;
  float w = bx * ay - by * ax;
  if (u == 0.0f || v == 0.0f || w == 0.0f) {  // products of two floats are exact in double precision
    u = static_cast<float>(static_cast<double>(cx) * by - static_cast<double>(cy) * bx);
    v = static_cast<float>(static_cast<double>(ax) * cy - static_cast<double>(ay) * cx);
    w = static_cast<float>(static_cast<double>(bx) * ay - static_cast<double>(by) * ax);
  }
  if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return false;
  const float determinant = u + v + w;
  if (determinant == 0.0f) return false;

  const float az = shear.sz * a[shear.kz], bz = shear.sz * b[shear.kz], cz = shear.sz * c[shear.kz];
  const float t = (u * az + v * bz + w * cz) / determinant;
  if (!(t >= t_min && t <= t_max)) return false;
  hit.t = t;
  hit.u = v / determinant;
  hit.v = w / determinant;
  return true;
}

}  // namespace kerf
