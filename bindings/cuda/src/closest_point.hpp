// The closest point of a surface, as the library finds it.
#pragma once

#include <kerf/query.hpp>

#include "closest_on_triangle.hpp"
#include "contains.hpp"
#include "trace.hpp"

namespace kerf::cuda {

/// Squared distances to boxes in single precision, with the world scaled by a power of two to coordinates
/// below 1: no square leaves the range of a float. The library's `PointBoxes`.
class NearPointBoxes {
 public:
  KERF_CUDA_INLINE NearPointBoxes(const Vec3f& p, const SceneBounds& bounds) {
    float largest = standard_max(standard_max(absolute(p.x), absolute(p.y)), absolute(p.z));
    for (int axis = 0; axis < 3; ++axis)
      largest =
          standard_max(largest, standard_max(absolute(bounds.lower[axis]), absolute(bounds.upper[axis])));
    // 2^(-exponent - 1) of the largest, which has at least 2^-100.
    const int exponent = static_cast<int>(as_bits(standard_max(largest, 0x1p-100f)) >> 23) - 127;
    const int wanted = standard_min(-exponent - 1, 100);
    scale_ = wanted < -126 ? 0x1p-127f : as_float(static_cast<std::uint32_t>(wanted + 127) << 23);
    point_[0] = p.x * scale_;
    point_[1] = p.y * scale_;
    point_[2] = p.z * scale_;
  }
  KERF_CUDA_INLINE float distance(const Words4& xy, std::uint32_t lower_z, std::uint32_t upper_z) const {
    const float x = outside(0, as_float(xy.x), as_float(xy.y)),
                y = outside(1, as_float(xy.z), as_float(xy.w)),
                z = outside(2, as_float(lower_z), as_float(upper_z));
    return fused_multiply_add(x, x, fused_multiply_add(y, y, z * z));
  }
  /// What no distance exceeds of a box that has a point at `squared_distance`.
  KERF_CUDA_INLINE float limit(double squared_distance) const {
    const double scaled = squared_distance * scale_ * scale_;
    return static_cast<float>(standard_min(scaled * (1.0 + 0x1p-20) + 0x1p-100, 0x1p127));
  }

 private:
  KERF_CUDA_INLINE float outside(int axis, float lower, float upper) const {
    const float before = fused_multiply_add(lower, scale_, -point_[axis]);
    const float behind = fused_multiply_add(-upper, scale_, point_[axis]);
    return maximum(maximum(before, behind), 0.0f);
  }

  float scale_, point_[3];
};

KERF_CUDA_INLINE double squared_distance(const Vec3f& p, const float (&lower)[3], const float (&upper)[3]) {
  constexpr double below = 1.0 - 16.0 / 9007199254740992.0;
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = component(p, axis);
    const double d = standard_max(standard_max(0.0, lower[axis] - at), at - upper[axis]);
    sum += d * d;
  }
  return sum * below;
}

/// Distances in double precision, less that of the whole world: for points from which that is nearly all
/// there is.
class FarPointBoxes {
 public:
  KERF_CUDA_INLINE FarPointBoxes(const Vec3f& p, const SceneBounds& bounds)
      : point_(p), nearest_(squared_distance(p, bounds.lower, bounds.upper)) {
    scale_ = 1.0 / standard_max(nearest_, 0x1p-1000);
  }
  KERF_CUDA_INLINE float distance(const Words4& xy, std::uint32_t lower_z, std::uint32_t upper_z) const {
    const float lower[3] = {as_float(xy.x), as_float(xy.z), as_float(lower_z)};
    const float upper[3] = {as_float(xy.y), as_float(xy.w), as_float(upper_z)};
    return static_cast<float>(standard_max(0.0, squared_distance(point_, lower, upper) - nearest_) * scale_);
  }
  KERF_CUDA_INLINE float limit(double squared_distance) const {
    const double most =
        standard_min((squared_distance - nearest_) * scale_ * (1.0 + 0x1p-20) + 0x1p-100, 0x1p127);
    return static_cast<float>(standard_max(most, 0.0));
  }

 private:
  Vec3f point_;
  double nearest_, scale_;
};

/// A triangle's point that is the closest so far.
struct NearestTriangle {
  ClosestOnTriangle at;
  std::uint32_t number;  ///< `invalid_id` for none
  std::uint32_t place;   ///< of its reference
};

/// Into the nearer child first, until no box that is left is as near as the closest triangle.
template <class Boxes>
KERF_CUDA_INLINE NearestTriangle find_nearest(const BinaryHierarchy& hierarchy, const Vec3f& point,
                                              double reach) {
  const Boxes boxes(point, *hierarchy.bounds);
  NearestTriangle best{{reach, 0.0, 0.0}, invalid_id, 0};
  float limit = boxes.limit(reach);
  std::uint32_t stack[max_depth + 1];
  float distances[max_depth + 1];
  std::uint32_t depth = 0, link = 0;
  while (true) {
    if ((link & leaf_bit) == 0) {
      const Words4* node = reinterpret_cast<const Words4*>(hierarchy.nodes + link);
      const Words4 first = load(node), second = load(node + 1), z = load(node + 2), links = load(node + 3);
      const float to_first = boxes.distance(first, z.x, z.y), to_second = boxes.distance(second, z.z, z.w);
      const bool first_is_nearer = to_first <= to_second;
      const float nearer = first_is_nearer ? to_first : to_second,
                  farther = first_is_nearer ? to_second : to_first;
      if (farther <= limit) {
        stack[depth] = first_is_nearer ? links.y : links.x;
        distances[depth++] = farther;
      }
      if (nearer <= limit) {
        link = first_is_nearer ? links.x : links.y;
        continue;
      }
    } else {
      const std::uint32_t begin = leaf_first(link), end = begin + leaf_count(link);
      for (std::uint32_t i = begin; i < end; ++i) {
        const DeviceTriangle& triangle = hierarchy.triangles[i];
        const std::uint32_t number = number_of(triangle);
        const CornersFromPoint corners(point, corners_of(triangle));
        if (number == invalid_id || plane_is_beyond(corners, best.at.squared_distance)) continue;
        const ClosestOnTriangle found = closest_on(corners);
        if (!(found.squared_distance <= best.at.squared_distance)) continue;
        if (found.squared_distance == best.at.squared_distance && number >= best.number) continue;
        best = {found, number, i};
        limit = boxes.limit(found.squared_distance);
      }
    }
    do {
      if (depth == 0) return best;
      --depth;
    } while (distances[depth] > limit);
    link = stack[depth];
  }
}

// Whether the world, seen from `point`, is too small for `NearPointBoxes`.
KERF_CUDA_INLINE bool is_far(const Vec3f& point, const SceneBounds& bounds) {
  double most = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    most = standard_max(most, static_cast<double>(bounds.upper[axis]) - bounds.lower[axis]);
  most *= 256.0;
  return squared_distance(point, bounds.lower, bounds.upper) > most * most;
}

KERF_CUDA_INLINE bool is_finite(const Vec3f& p) {
  return (0.0f * p.x + 0.0f * p.y) + 0.0f * p.z == 0.0f;
}

/// One with an invalid primitive where no triangle is within `max_distance`.
KERF_CUDA_INLINE SurfacePoint closest_point(const BinaryHierarchy& hierarchy, const MeshTable& meshes,
                                            const Vec3f& point, float max_distance) {
  SurfacePoint result;
  if (!is_finite(point) || !(max_distance >= 0.0f) || hierarchy.node_count == 0) return result;
  const double reach = static_cast<double>(max_distance) * max_distance;
  const NearestTriangle nearest = is_far(point, *hierarchy.bounds)
                                      ? find_nearest<FarPointBoxes>(hierarchy, point, reach)
                                      : find_nearest<NearPointBoxes>(hierarchy, point, reach);
  if (nearest.number == invalid_id) return result;
  const Corners corners = corners_of(hierarchy.triangles[nearest.place]);
  const double u = nearest.at.u, v = nearest.at.v;
  result.position.x = static_cast<float>((1.0 - u - v) * corners.a.x + u * corners.b.x + v * corners.c.x);
  result.position.y = static_cast<float>((1.0 - u - v) * corners.a.y + u * corners.b.y + v * corners.c.y);
  result.position.z = static_cast<float>((1.0 - u - v) * corners.a.z + u * corners.b.z + v * corners.c.z);
  result.distance = static_cast<float>(std::sqrt(nearest.at.squared_distance));
  result.u = static_cast<float>(u);
  result.v = static_cast<float>(v);
  const PrimitiveId place = meshes.locate(nearest.number);
  result.primitive = place.primitive;
  result.mesh = place.mesh;
  return result;
}

KERF_CUDA_INLINE float signed_distance(const BinaryHierarchy& hierarchy, const MeshTable& meshes,
                                       const Vec3f& point) {
  const SurfacePoint closest = closest_point(hierarchy, meshes, point, as_float(0x7f800000u));
  if (closest.primitive == invalid_id) return as_float(0x7f800000u);
  return contains(hierarchy, point) ? -closest.distance : closest.distance;
}

}  // namespace kerf::cuda
