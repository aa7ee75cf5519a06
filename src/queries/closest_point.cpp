// The triangles near a point: the closest, the nearest few, and all within a distance.
#include <algorithm>
#include <cmath>

#include <kerf/bvh.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "math/vec3f.hpp"
#include "queries/batches.hpp"
#include "queries/points.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

bool has_sense(const Structure& structure, const Vec3f& point, float distance) {
  return is_finite(point) && distance >= 0.0f && !structure.wide.empty();
}

// Appends the points of the triangles found, nearest first.
void append_in_order(const Structure& structure, std::vector<NearTriangle>& found,
                     std::vector<SurfacePoint>& points) {
  std::sort(found.begin(), found.end(),
            [](const NearTriangle& a, const NearTriangle& b) { return is_nearer(a, b); });
  const auto same = [](const NearTriangle& a, const NearTriangle& b) { return a.id == b.id; };
  found.erase(std::unique(found.begin(), found.end(), same), found.end());
  for (const NearTriangle& near : found) points.push_back(surface_point(structure, near));
}

void append_within(const Structure& structure, const Vec3f& point, float radius,
                   std::vector<SurfacePoint>& points) {
  if (!has_sense(structure, point, radius)) return;
  std::vector<NearTriangle> found;
  structure.kernels->triangles_within(structure.wide, point, static_cast<double>(radius) * radius, found);
  append_in_order(structure, found, points);
}

void append_nearest(const Structure& structure, const Vec3f& point, std::size_t count, float max_distance,
                    std::vector<SurfacePoint>& points) {
  if (count == 0 || !has_sense(structure, point, max_distance)) return;
  std::vector<NearTriangle> found;
  structure.kernels->nearest_triangles(structure.wide, point,
                                       static_cast<double>(max_distance) * max_distance, count, found);
  append_in_order(structure, found, points);
}

}  // namespace

SurfacePoint surface_point(const Structure& structure, const NearTriangle& near) {
  const Triangle triangle = triangle_in(structure.wide, near.leaf, near.place);
  SurfacePoint point;
  for (int axis = 0; axis < 3; ++axis) {
    point.position[axis] = static_cast<float>((1.0 - near.u - near.v) * triangle.v0[axis] +
                                              near.u * triangle.v1[axis] + near.v * triangle.v2[axis]);
  }
  const PrimitiveId place = locate(structure, near.id);
  point.distance = static_cast<float>(std::sqrt(near.squared_distance));
  point.u = static_cast<float>(near.u);
  point.v = static_cast<float>(near.v);
  point.primitive = place.primitive;
  point.mesh = place.mesh;
  return point;
}

SurfacePoint closest_point(const Structure& structure, const Vec3f& point, float max_distance) {
  NearTriangle closest;
  if (!has_sense(structure, point, max_distance) ||
      !structure.kernels->closest_triangle(structure.wide, point,
                                           static_cast<double>(max_distance) * max_distance, closest))
    return {};
  return surface_point(structure, closest);
}

std::optional<SurfacePoint> Bvh::closest_point(const Vec3f& point, float max_distance) const {
  const PlainFloatingPoint plain;
  const SurfacePoint closest = kerf::closest_point(*structure_, point, max_distance);
  return closest ? std::optional(closest) : std::nullopt;
}

void Bvh::closest_point(const PointView& points, std::span<SurfacePoint> closest, float max_distance,
                        const BatchOptions& options) const {
  require_as_many(points.size(), closest.size(), "as many closest points as points are needed");
  for_each_point(points, options, [&](std::size_t i, const Vec3f& point) {
    closest[i] = kerf::closest_point(*structure_, point, max_distance);
  });
}

std::vector<SurfacePoint> Bvh::within(const Vec3f& point, float radius) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    std::vector<SurfacePoint> points;
    append_within(*structure_, point, radius, points);
    return points;
  });
}

Lists<SurfacePoint> Bvh::within(const PointView& points, float radius, const BatchOptions& options) const {
  return list_in_batches<SurfacePoint>(points.size(), points_per_batch, options,
                                       [&](std::size_t i, std::vector<SurfacePoint>& found) {
                                         append_within(*structure_, points[i], radius, found);
                                       });
}

std::vector<SurfacePoint> Bvh::nearest(const Vec3f& point, std::size_t count, float max_distance) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    std::vector<SurfacePoint> points;
    append_nearest(*structure_, point, count, max_distance, points);
    return points;
  });
}

Lists<SurfacePoint> Bvh::nearest(const PointView& points, std::size_t count, float max_distance,
                                 const BatchOptions& options) const {
  return list_in_batches<SurfacePoint>(points.size(), points_per_batch, options,
                                       [&](std::size_t i, std::vector<SurfacePoint>& found) {
                                         append_nearest(*structure_, points[i], count, max_distance, found);
                                       });
}

}  // namespace kerf
