#include <algorithm>
#include <cmath>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "math/vec3f.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

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

}  // namespace

std::optional<SurfacePoint> Bvh::closest_point(const Vec3f& point, float max_distance) const {
  const PlainFloatingPoint plain;
  if (!is_finite(point) || !(max_distance >= 0.0f) || structure_->wide.empty()) return std::nullopt;
  const double reach = static_cast<double>(max_distance) * max_distance;
  NearTriangle closest;
  if (!structure_->kernels->closest_triangle(structure_->wide, point, reach, closest)) return std::nullopt;
  return surface_point(*structure_, closest);
}

std::vector<SurfacePoint> Bvh::within(const Vec3f& point, float radius) const {
  const PlainFloatingPoint plain;
  std::vector<SurfacePoint> points;
  if (!is_finite(point) || !(radius >= 0.0f) || structure_->wide.empty()) return points;
  const double reach = static_cast<double>(radius) * radius;
  report_out_of_memory([&] {
    std::vector<NearTriangle> found;
    structure_->kernels->triangles_within(structure_->wide, point, reach, found);
    std::sort(found.begin(), found.end(),
              [](const NearTriangle& a, const NearTriangle& b) { return is_nearer(a, b); });
    const auto same = [](const NearTriangle& a, const NearTriangle& b) { return a.id == b.id; };
    found.erase(std::unique(found.begin(), found.end(), same), found.end());
    points.reserve(found.size());
    for (const NearTriangle& near : found) points.push_back(surface_point(*structure_, near));
  });
  return points;
}

}  // namespace kerf
