// Rays through a scene: closest hit, any hit, all hits, and the parity of the crossings from a point.
#include <algorithm>
#include <vector>

#include <kerf/scene.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "math/vec3f.hpp"
#include "queries/batches.hpp"
#include "queries/points.hpp"
#include "queries/ray_columns.hpp"
#include "scene/places.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

SceneHit named(const Structure& object, Hit hit, std::uint32_t instance) {
  name_triangle(object, hit);
  return {hit.t, hit.u, hit.v, hit.primitive, hit.mesh, instance};
}

// The triangle of `best` is named at the end; until then it has its number in the object.
SceneHit closest_hit(const SceneStructure& scene, const Ray& ray) {
  Hit best;
  std::uint32_t instance = invalid_id;
  const Structure* object = nullptr;
  best.t = ray.t_max;
  visit_objects(scene, ray, nullptr, [&](const MetObject& met) {
    Hit hit;
    met.object().kernels->closest(met.object().wide, met.ray.ray, hit);
    hit.t = met.ray.in_scene(hit.t);
    if (hit && (hit.t < best.t || met.number < instance)) {
      best = hit;
      instance = met.number;
      object = &met.object();
    }
    return best.t;
  });
  return object == nullptr ? SceneHit{} : named(*object, best, instance);
}

bool any_hit(const SceneStructure& scene, const Ray& ray) {
  bool found = false;
  visit_objects(scene, ray, nullptr, [&](const MetObject& met) {
    found = met.object().kernels->any(met.object().wide, met.ray.ray);
    return found ? end_of_ray : ray.t_max;
  });
  return found;
}

bool is_earlier(const SceneHit& a, const SceneHit& b) {
  if (a.t != b.t) return a.t < b.t;
  if (a.instance != b.instance) return a.instance < b.instance;
  return a.mesh != b.mesh ? a.mesh < b.mesh : a.primitive < b.primitive;
}

std::size_t count_all(const SceneStructure& scene, const Ray& ray) {
  std::size_t count = 0;
  visit_objects(scene, ray, nullptr, [&](const MetObject& met) {
    count += met.object().kernels->count_crossings(met.object().wide, met.ray.ray);
    return ray.t_max;
  });
  return count;
}

// As `side_of` in the objects' kernels: oblique to all coordinate planes.
constexpr Vec3f oblique{0.8571f, 0.3163f, 0.4067f};

Side side_of(const SceneStructure& scene, const Vec3f& point) {
  if (!is_finite(point)) return Side::outside;
  const Ray ray{.origin = point, .direction = oblique};
  std::size_t crossings = 0;
  bool on = false;
  visit_objects(scene, ray, nullptr, [&](const MetObject& met) {
    const Vec3f& local = met.ray.ray.origin;
    const Structure& object = met.object();
    if (!intersect(object.wide.bounds, {local, local}).empty() &&
        object.kernels->side_of(object.wide, local) == Side::on) {
      on = true;
      return end_of_ray;
    }
    crossings += object.kernels->count_crossings(object.wide, met.ray.ray);
    return ray.t_max;
  });
  return on ? Side::on : crossings % 2 == 1 ? Side::inside : Side::outside;
}

// All hits of one ray, in their order, behind those that `hits` has.
void append_hits(const SceneStructure& scene, const Ray& ray, std::vector<SceneHit>& hits) {
  const auto before = static_cast<std::ptrdiff_t>(hits.size());
  visit_objects(scene, ray, nullptr, [&](const MetObject& met) {
    met.bvh().all_hits(met.ray.ray, [&](const Hit& hit) {
      hits.push_back({met.ray.in_scene(hit.t), hit.u, hit.v, hit.primitive, hit.mesh, met.number});
    });
    return ray.t_max;
  });
  std::sort(hits.begin() + before, hits.end(), is_earlier);
}

}  // namespace

std::optional<SceneHit> Scene::intersect(const Ray& ray) const {
  const SceneHit hit = closest_hit(*structure_, ray);
  return hit ? std::optional(hit) : std::nullopt;
}
bool Scene::occluded(const Ray& ray) const {
  return any_hit(*structure_, ray);
}

void Scene::intersect(const RayView& rays, std::span<SceneHit> hits, const BatchOptions& options) const {
  require_as_many(rays.count, hits.size(), "as many hits as rays are needed");
  for_each_batch(rays.count, rays_per_batch, options, [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i) {
      hits[i] = rays.mask.data == nullptr ? closest_hit(*structure_, ray_at(rays, i))
                                          : intersect(ray_at(rays, i), mask_at(rays, i)).value_or(SceneHit{});
    }
  });
}

void Scene::occluded(const RayView& rays, const FlagView& occluded, const BatchOptions& options) const {
  require_as_many(rays.count, occluded.size(), "as many results as rays are needed");
  for_each_batch(rays.count, rays_per_batch, options, [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i) {
      occluded.set(i, rays.mask.data == nullptr ? any_hit(*structure_, ray_at(rays, i))
                                                : this->occluded(ray_at(rays, i), mask_at(rays, i)));
    }
  });
}

std::vector<SceneHit> Scene::list_hits(const Ray& ray) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    std::vector<SceneHit> hits;
    append_hits(*structure_, ray, hits);
    return hits;
  });
}

Lists<SceneHit> Scene::all_hits(const RayView& rays, const BatchOptions& options) const {
  return list_in_batches<SceneHit>(
      rays.count, rays_per_batch, options,
      [&](std::size_t i, std::vector<SceneHit>& hits) { append_hits(*structure_, ray_at(rays, i), hits); });
}

std::size_t Scene::count_hits(const Ray& ray) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] { return count_all(*structure_, ray); });
}

void Scene::count_hits(const RayView& rays, std::span<std::uint32_t> counts,
                       const BatchOptions& options) const {
  require_as_many(rays.count, counts.size(), "as many results as rays are needed");
  for_each_batch(rays.count, rays_per_batch, options, [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i)
      counts[i] = static_cast<std::uint32_t>(count_all(*structure_, ray_at(rays, i)));
  });
}

Side Scene::side(const Vec3f& point) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] { return side_of(*structure_, point); });
}

void Scene::side(const PointView& points, std::span<Side> sides, const BatchOptions& options) const {
  require_as_many(points.size(), sides.size(), "as many sides as points are needed");
  for_each_point(points, options,
                 [&](std::size_t i, const Vec3f& point) { sides[i] = side_of(*structure_, point); });
}

bool Scene::contains(const Vec3f& point) const {
  return side(point) != Side::outside;
}

void Scene::contains(const PointView& points, const FlagView& inside, const BatchOptions& options) const {
  require_as_many(points.size(), inside.size(), "as many results as points are needed");
  for_each_point(points, options, [&](std::size_t i, const Vec3f& point) {
    inside.set(i, side_of(*structure_, point) != Side::outside);
  });
}

}  // namespace kerf
