// The point of a triangle that is closest to a given one, as the library computes it, operation by operation.
#pragma once

#include "predicates.hpp"

namespace kerf::cuda {

KERF_CUDA_INLINE double size(const Vec3d& a) {
  return absolute(a.x) + absolute(a.y) + absolute(a.z);
}

/// Corners as differences from the point, edges as differences of corners.
struct CornersFromPoint {
  Vec3d a, b, c, ab, bc, ca;

  KERF_CUDA_INLINE CornersFromPoint(const Vec3f& p, const Corners& t)
      : a(difference(t.a, p)),
        b(difference(t.b, p)),
        c(difference(t.c, p)),
        ab(difference(t.b, t.a)),
        bc(difference(t.c, t.b)),
        ca(difference(t.a, t.c)) {}
};

/// At `(1 - u - v) * v0 + u * v1 + v * v2`.
struct ClosestOnTriangle {
  double squared_distance, u, v;
};

// The closest point of the edge between two corners, `s` of the way from `from` to `to`. From the nearer end,
// which is exact there.
KERF_CUDA_INLINE double closest_on_edge(const Vec3d& from, const Vec3d& to, const Vec3d& edge, double& s) {
  const double length = dot(edge, edge);
  const double foot = -dot(from, edge) / length;
  s = length > 0.0 ? standard_min(foot > 0.0 ? foot : 0.0, 1.0) : 0.0;
  const bool near_from = s <= 0.5;
  const double way = near_from ? s : s - 1.0;
  const Vec3d& end = near_from ? from : to;
  const Vec3d q{end.x + way * edge.x, end.y + way * edge.y, end.z + way * edge.z};
  return dot(q, q);
}

/// Whether the plane of the triangle is farther than the square root of `reach`. False where rounding leaves
/// that open.
KERF_CUDA_INLINE bool plane_is_beyond(const CornersFromPoint& t, double reach) {
  const Vec3d normal = cross(t.ca, t.ab);
  constexpr double rounding = 32.0 / 9007199254740992.0;
  const double error = rounding * (size(t.ab) * size(t.ca));
  const double height = absolute(dot(normal, t.a)) - error * size(t.a);
  constexpr double d = 1e-6;
  const double square =
      ((1.0 + d) * (1.0 + d)) * dot(normal, normal) + ((1.0 + 1.0 / d) * (1.0 + d)) * (error * error);
  return height > 0.0 && reach * square < height * height;
}

KERF_CUDA_INLINE ClosestOnTriangle closest_on(const CornersFromPoint& t) {
  double s;
  ClosestOnTriangle best{closest_on_edge(t.a, t.b, t.ab, s), 0.0, 0.0};
  best.u = s;
  const double on_bc = closest_on_edge(t.b, t.c, t.bc, s);
  if (on_bc < best.squared_distance) best = {on_bc, 1.0 - s, s};
  const double on_ca = closest_on_edge(t.c, t.a, t.ca, s);
  if (on_ca < best.squared_distance) best = {on_ca, 0.0, 1.0 - s};

  const Vec3d normal = cross(t.ca, t.ab);
  const double wa = dot(normal, cross(t.b, t.c)), wb = dot(normal, cross(t.c, t.a)),
               wc = dot(normal, cross(t.a, t.b));
  if (standard_min(standard_min(wa, wb), wc) > 0.0) {
    const double height = dot(normal, t.a);
    const double on_face = height * height / dot(normal, normal);
    const double sum = wa + wb + wc;
    if (on_face < best.squared_distance) best = {on_face, wb / sum, wc / sum};
  }
  return best;
}

}  // namespace kerf::cuda
