#include "workbench/bench/peers/kerf_engine.hpp"

#include <string>

#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

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

}  // namespace

Engine kerf_engine(const kerf::BuildOptions& options, std::string version) {
  const auto build = [options](const kerf::TriangleMesh& mesh) {
    const kerf::Bvh bvh = kerf::build(mesh, options);
    const unsigned threads = options.threads;
    Tracer single{.engine = "kerf",
                  .mode = "single",
                  .intersect =
                      [bvh, threads](std::span<const kerf::Ray> rays, std::span<kerf::Hit> hits) {
                        for_ray_blocks(threads, rays.size(), [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i) {
                            hits[i] = bvh.intersect(rays[i]).value_or(kerf::Hit{});
                          }
                        });
                      },
                  .occluded =
                      [bvh, threads](std::span<const kerf::Ray> rays, std::span<std::uint8_t> results) {
                        for_ray_blocks(threads, rays.size(), [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i) results[i] = bvh.occluded(rays[i]);
                        });
                      },
                  .intersect_made =
                      [bvh, threads](const RaySet& set, std::size_t first, std::span<kerf::Hit> hits) {
                        for_made_rays(threads, set, first, hits, [&] {
                          return [&bvh, ray = kerf::Ray{}](const MadeRay& made, float t_max) mutable {
                            write(ray, made, t_max);
                            return bvh.intersect(ray);
                          };
                        });
                      },
                  .occluded_made =
                      [bvh, threads](const RaySet& set, std::size_t first, std::span<std::uint8_t> results) {
                        for_made_rays(threads, set, first, results, [&] {
                          return [&bvh, ray = kerf::Ray{}](const MadeRay& made, float t_max) mutable {
                            write(ray, made, t_max);
                            return bvh.occluded(ray);
                          };
                        });
                      }};
    Tracer batch{.engine = "kerf",
                 .mode = "batch",
                 .intersect = [bvh](std::span<const kerf::Ray> rays,
                                    std::span<kerf::Hit> hits) { bvh.intersect(rays, hits); },
                 .occluded = [bvh](std::span<const kerf::Ray> rays,
                                   std::span<std::uint8_t> results) { bvh.occluded(rays, results); }};
    return Traceable{.bytes = bvh.statistics().bytes,
                     .build_peak_bytes = bvh.statistics().build_peak_bytes,
                     .tracers = {std::move(single), std::move(batch)}};
  };
  return {.name = "kerf",
          .version = "kerf " + version,
          .isa = std::string(kerf::instruction_set()),
          .build = build};
}

}  // namespace workbench
