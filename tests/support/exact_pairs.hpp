// Whether two triangles have a point in common, in rational numbers.
#pragma once

#include <algorithm>
#include <vector>

#include "support/exact_oracle.hpp"

namespace exact {

/// By separating axes: two convex polygons in space without a common point are separated along the normal of
/// one, a cross product of two edges, or within the plane of one across an edge. A polygon may be a segment
/// or a point.
inline bool touch(const kerf::Triangle& first, const kerf::Triangle& second) {
  const Vector p[3] = {vector(first.v0), vector(first.v1), vector(first.v2)};
  const Vector q[3] = {vector(second.v0), vector(second.v1), vector(second.v2)};
  Vector e[3], f[3];
  for (int i = 0; i < 3; ++i) {
    e[i] = p[(i + 1) % 3] - p[i];
    f[i] = q[(i + 1) % 3] - q[i];
  }
  const Vector n = cross(e[0], e[1]), m = cross(f[0], f[1]);
  std::vector<Vector> axes{n, m};
  for (const Vector& a : e) {
    for (const Vector& b : f) axes.push_back(cross(a, b));
    axes.push_back(cross(n, a));
    axes.push_back(cross(m, a));
  }
  for (const Vector& b : f) {
    axes.push_back(cross(n, b));
    axes.push_back(cross(m, b));
  }
  return std::none_of(axes.begin(), axes.end(), [&](const Vector& axis) {
    const auto [p_min, p_max] = std::minmax({dot(axis, p[0]), dot(axis, p[1]), dot(axis, p[2])});
    const auto [q_min, q_max] = std::minmax({dot(axis, q[0]), dot(axis, q[1]), dot(axis, q[2])});
    return p_max < q_min || q_max < p_min;
  });
}

}  // namespace exact
