// The oracle of the tracing tests: every triangle is tried, in no order, with no boxes.
#pragma once

#include <optional>

#include <kerf/kerf.hpp>

#include "layout/wide_bvh.hpp"
#include "math/ray_box.hpp"
#include "math/ray_triangle.hpp"
#include "traversal/rays/prepared_ray.hpp"
#include "tree/geometry.hpp"

/// `scene` bounds what else there is: in vast scenes directions are scaled otherwise, and keep components so
/// much smaller than the largest that they are lost elsewhere.
inline std::optional<kerf::Hit> brute_force(const kerf::TriangleMesh& mesh, const kerf::Ray& caller_ray,
                                            const kerf::Box3f& scene = {}) {
  const bool is_far =
      !scene.empty() &&
      !(kerf::far_side(caller_ray.origin, scene) + kerf::largest_coordinate(scene) < kerf::PreparedRay::far);
  const kerf::PreparedRay ray(caller_ray, is_far);
  if (!ray.valid()) return std::nullopt;
  const kerf::Geometry geometry(std::span<const kerf::TriangleMesh>(&mesh, 1));
  const kerf::RayShear shear(ray.direction);
  kerf::Hit best;
  best.t = ray.t_max;
  for (std::uint32_t i = 0; i < geometry.triangle_count(); ++i) {
    kerf::Hit hit;
    if (!intersect_triangle(shear, ray.origin, ray.direction, geometry.triangle(i), ray.t_min, best.t, hit))
      continue;
    hit.primitive = i;
    hit.mesh = 0;
    if (hit.t < best.t || hit.primitive < best.primitive) best = hit;
  }
  if (!best) return std::nullopt;
  best.t = ray.unscaled(best.t);
  return best;
}
