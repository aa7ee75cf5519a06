// Distances from a point to boxes and triangles, in double precision.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/predicates.hpp"
#include "math/triangle.hpp"

namespace kerf {

inline double dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3d operator-(const Vec3d& a, const Vec3d& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// The squared distance to the nearest point of the box, at most a few roundings too small.
inline double squared_distance(const Vec3f& p, const Box3f& box) {
  constexpr double below =
      1.0 - 16.0 / 9007199254740992.0;  // differences, squares and sums: under 7 * 2^-53, twice
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = std::max({0.0, static_cast<double>(box.lower[axis]) - p[axis],
                               static_cast<double>(p[axis]) - box.upper[axis]});
    sum += d * d;
  }
  return sum * below;
}

/// The point of a triangle closest to a given one: `(1 - u - v) * v0 + u * v1 + v * v2`.
struct ClosestOnTriangle {
  double squared_distance;
  double u, v;
};

/// Whether the plane of `triangle`, and so the triangle, is farther from `p` than the square root of `reach`.
/// False where rounding leaves that open.
inline bool plane_is_beyond(const Vec3f& p, const Triangle& triangle, double reach) {
  const auto size = [](const Vec3d& a) { return std::abs(a.x) + std::abs(a.y) + std::abs(a.z); };
  const Vec3d ab = difference(triangle.v1, triangle.v0), ac = difference(triangle.v2, triangle.v0);
  const Vec3d pa = difference(triangle.v0, p);
  const Vec3d normal = cross(ab, ac);
  // Some ten roundings of 2^-53 on products of these sizes; of a sliver they are most of what the normal is.
  constexpr double rounding = 32.0 / 9007199254740992.0;
  const double error = rounding * size(ab) * size(ac);
  const double height = std::abs(dot(normal, pa)) - error * size(pa);
  // (n + e)^2 <= (1 + d) n^2 + (1 + 1 / d) e^2
  constexpr double d = 1e-6;
  const double square = (1.0 + d) * dot(normal, normal) + (1.0 + 1.0 / d) * error * error;
  return height > 0.0 && height * height > reach * square * (1.0 + d);
}

/// The closest of the three edges' points, or the foot of the perpendicular where that falls inside. Slivers
/// keep their accuracy: an edge's point needs no division by the triangle's area.
inline ClosestOnTriangle closest_on_triangle(const Vec3f& p, const Triangle& triangle) {
  const Vec3d pa = difference(triangle.v0, p), pb = difference(triangle.v1, p),
              pc = difference(triangle.v2, p);
  const auto along = [](const Vec3d& from, const Vec3d& to, double& s) {
    const Vec3d edge = to - from;
    const double length = dot(edge, edge);
    s = length > 0.0 ? std::clamp(-dot(from, edge) / length, 0.0, 1.0) : 0.0;
    // From the nearer end, which is exact there.
    const Vec3d q =
        s <= 0.5 ? Vec3d{from.x + s * edge.x, from.y + s * edge.y, from.z + s * edge.z}
                 : Vec3d{to.x - (1.0 - s) * edge.x, to.y - (1.0 - s) * edge.y, to.z - (1.0 - s) * edge.z};
    return dot(q, q);
  };
  double s = 0.0;
  ClosestOnTriangle best{along(pa, pb, s), 0.0, 0.0};
  best.u = s;
  if (const double d = along(pb, pc, s); d < best.squared_distance) best = {d, 1.0 - s, s};
  if (const double d = along(pc, pa, s); d < best.squared_distance) best = {d, 0.0, 1.0 - s};

  const Vec3d normal = cross(difference(triangle.v1, triangle.v0), difference(triangle.v2, triangle.v0));
  const double wa = dot(normal, cross(pb, pc)), wb = dot(normal, cross(pc, pa)),
               wc = dot(normal, cross(pa, pb));
  if (wa > 0.0 && wb > 0.0 && wc > 0.0) {
    const double height = dot(normal, pa);
    const double d = height * height / dot(normal, normal);
    if (d < best.squared_distance) best = {d, wb / (wa + wb + wc), wc / (wa + wb + wc)};
  }
  return best;
}

}  // namespace kerf
