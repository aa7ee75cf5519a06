#include "workbench/bench/peers/kerf_engine.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "workbench/bench/peers/made_rays.hpp"
#include "workbench/bench/peers/ray_blocks.hpp"

namespace workbench {
namespace {

void write(kerf::Ray& ray, const MadeRay& made, float t_max) {
  write_fields(ray.origin.x, ray.origin.y, ray.origin.z, made.origin);
  write_fields(ray.direction.x, ray.direction.y, ray.direction.z, made.direction);
  write_field(ray.t_min, 0.0f);
  write_field(ray.t_max, t_max);
}

kerf::Hit to_hit(const kerf::SceneHit& hit) {
  return {hit.t, hit.u, hit.v, hit.primitive, hit.mesh};
}

// As a program has it that keeps no instances.
std::optional<kerf::Hit> find(const kerf::Bvh& bvh, const kerf::Ray& ray) {
  return bvh.intersect(ray);
}
std::optional<kerf::Hit> find(const kerf::Scene& scene, const kerf::Ray& ray) {
  const auto hit = scene.intersect(ray);
  return hit ? std::optional(to_hit(*hit)) : std::nullopt;
}

void intersect_batch(const kerf::Bvh& bvh, std::span<const kerf::Ray> rays, std::span<kerf::Hit> hits) {
  bvh.intersect(rays, hits);
}
void intersect_batch(const kerf::Scene& scene, std::span<const kerf::Ray> rays, std::span<kerf::Hit> hits) {
  std::vector<kerf::SceneHit> found(rays.size());
  scene.intersect(rays, found);
  std::transform(found.begin(), found.end(), hits.begin(),
                 [](const kerf::SceneHit& hit) { return to_hit(hit); });
}

// Of a `kerf::Bvh` or a `kerf::Scene`.
template <class Traced>
std::vector<Tracer> tracers(const Traced& traced, unsigned threads) {
  Tracer single{.engine = "kerf",
                .mode = "single",
                .intersect =
                    [traced, threads](std::span<const kerf::Ray> rays, std::span<kerf::Hit> hits) {
                      for_ray_blocks(threads, rays.size(), [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i)
                          hits[i] = find(traced, rays[i]).value_or(kerf::Hit{});
                      });
                    },
                .occluded =
                    [traced, threads](std::span<const kerf::Ray> rays, std::span<std::uint8_t> results) {
                      for_ray_blocks(threads, rays.size(), [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) results[i] = traced.occluded(rays[i]);
                      });
                    },
                .intersect_made =
                    [traced, threads](const RaySet& set, std::size_t first, std::span<kerf::Hit> hits) {
                      for_made_rays(threads, set, first, hits, [&] {
                        return [&traced, ray = kerf::Ray{}](const MadeRay& made, float t_max) mutable {
                          write(ray, made, t_max);
                          return find(traced, ray);
                        };
                      });
                    },
                .occluded_made =
                    [traced, threads](const RaySet& set, std::size_t first, std::span<std::uint8_t> results) {
                      for_made_rays(threads, set, first, results, [&] {
                        return [&traced, ray = kerf::Ray{}](const MadeRay& made, float t_max) mutable {
                          write(ray, made, t_max);
                          return traced.occluded(ray);
                        };
                      });
                    }};
  Tracer batch{.engine = "kerf",
               .mode = "batch",
               .intersect = [traced](std::span<const kerf::Ray> rays,
                                     std::span<kerf::Hit> hits) { intersect_batch(traced, rays, hits); },
               .occluded = [traced](std::span<const kerf::Ray> rays,
                                    std::span<std::uint8_t> results) { traced.occluded(rays, results); }};
  return {std::move(single), std::move(batch)};
}

Mover mover(const kerf::TriangleMesh& mesh, const kerf::BuildOptions& options, bool refits) {
  const auto bvh = std::make_shared<kerf::Bvh>(kerf::build(mesh, options));
  const auto next_frame = [bvh, mesh, options, refits] {
    if (refits)
      kerf::refit(*bvh, mesh, options);
    else
      *bvh = kerf::build(mesh, options);
  };
  return {.engine = "kerf",
          .motion = refits ? "refit" : "rebuild",
          .next_frame = next_frame,
          .tracer = [bvh, threads = options.threads] { return tracers(*bvh, threads).front(); }};
}

}  // namespace

Engine kerf_engine(const kerf::BuildOptions& options, std::string version) {
  const auto build = [options](const kerf::TriangleMesh& mesh) {
    const kerf::Bvh bvh = kerf::build(mesh, options);
    return Traceable{.bytes = bvh.statistics().bytes,
                     .build_peak_bytes = bvh.statistics().build_peak_bytes,
                     .tracers = tracers(bvh, options.threads)};
  };
  const auto build_placed = [options](const PlacedMeshes& placed) {
    const std::vector<kerf::Bvh> objects = build_objects(placed, options);
    const kerf::Scene scene = build_scene(placed, objects, options);
    Traceable traceable{
        .bytes = scene.bytes(), .build_peak_bytes = 0, .tracers = tracers(scene, options.threads)};
    std::size_t peak = 0;  // of one object, beside all that were built before
    for (const kerf::Bvh& object : objects) {
      peak = std::max(peak, traceable.bytes + object.statistics().build_peak_bytes);
      traceable.bytes += object.statistics().bytes;
    }
    traceable.build_peak_bytes = std::max(peak, traceable.bytes);
    return traceable;
  };
  return {.name = "kerf",
          .version = "kerf " + version,
          .isa = std::string(kerf::instruction_set()),
          .build = build,
          .build_placed = build_placed,
          .movers = [options](const kerf::TriangleMesh& mesh) {
            return std::vector<Mover>{mover(mesh, options, true), mover(mesh, options, false)};
          }};
}

}  // namespace workbench
