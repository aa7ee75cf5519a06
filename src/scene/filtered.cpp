// Hits of the instances and meshes that a ray sees, and of those the hits that a caller accepts.
#include <optional>

#include <kerf/scene.hpp>

#include "queries/batches.hpp"
#include "queries/ray_columns.hpp"
#include "scene/places.hpp"

namespace kerf {
namespace {

SceneHit in_scene(const MetObject& met, const Hit& hit) {
  return {met.ray.in_scene(hit.t), hit.u, hit.v, hit.primitive, hit.mesh, met.number};
}

using Accept = bool (*)(void* context, const SceneHit& hit);

}  // namespace

std::optional<SceneHit> Scene::intersect_filtered(const Ray& ray, Mask mask, void* context,
                                                  Accept accept) const {
  SceneHit best;
  best.t = ray.t_max;
  visit_objects(*structure_, ray, &mask, [&](const MetObject& met) {
    const auto is_closer = [&](float t) { return t < best.t || met.number < best.instance; };
    const auto accepts = [&](const Hit& hit) {
      const SceneHit asked = in_scene(met, hit);
      return is_closer(asked.t) && accept(context, asked);
    };
    const auto hit = accept == nullptr ? met.bvh().intersect(met.ray.ray, mask)
                                       : met.bvh().intersect(met.ray.ray, mask, accepts);
    if (hit && is_closer(met.ray.in_scene(hit->t))) best = in_scene(met, *hit);
    return best.t;
  });
  return best ? std::optional(best) : std::nullopt;
}

bool Scene::occluded_filtered(const Ray& ray, Mask mask, void* context, Accept accept) const {
  bool found = false;
  visit_objects(*structure_, ray, &mask, [&](const MetObject& met) {
    const auto accepts = [&](const Hit& hit) { return accept(context, in_scene(met, hit)); };
    found = accept == nullptr ? met.bvh().occluded(met.ray.ray, mask)
                              : met.bvh().occluded(met.ray.ray, mask, accepts);
    return found ? end_of_ray : ray.t_max;
  });
  return found;
}

void Scene::intersect_filtered(const RayView& rays, std::span<SceneHit> hits, const BatchOptions& options,
                               const void* context, FilterOfMany accept) const {
  require_as_many(rays.count, hits.size(), "as many hits as rays are needed");
  for_each_batch(rays.count, rays_per_batch, options, [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i) {
      const auto filter = [&](const SceneHit& hit) { return accept(context, i, hit); };
      hits[i] = intersect(ray_at(rays, i), mask_at(rays, i), filter).value_or(SceneHit{});
    }
  });
}

void Scene::occluded_filtered(const RayView& rays, const FlagView& occluded, const BatchOptions& options,
                              const void* context, FilterOfMany accept) const {
  require_as_many(rays.count, occluded.size(), "as many results as rays are needed");
  for_each_batch(rays.count, rays_per_batch, options, [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i) {
      const auto filter = [&](const SceneHit& hit) { return accept(context, i, hit); };
      occluded.set(i, this->occluded(ray_at(rays, i), mask_at(rays, i), filter));
    }
  });
}

}  // namespace kerf
