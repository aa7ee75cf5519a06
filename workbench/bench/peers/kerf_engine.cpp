#include "workbench/bench/peers/kerf_engine.hpp"

#include <kerf/kerf.hpp>

#include "workbench/bench/peers/ray_blocks.hpp"

namespace workbench {

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
  return {.name = "kerf", .version = "kerf " + version, .build = build};
}

}  // namespace workbench
