// Whether anything is hit: of a ray, of many, and counted.
#include <algorithm>

#include <kerf/bvh.hpp>
#include <kerf/inspect.hpp>

#include "queries/batches.hpp"
#include "queries/ray_columns.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {

bool Bvh::occluded(const Ray& ray) const {
  const Structure& structure = *structure_;
  return !structure.wide.empty() && structure.kernels->any(structure.wide, ray);
}

void Bvh::occluded(const RayView& rays, const FlagView& occluded, const BatchOptions& options) const {
  if (rays.mask.data != nullptr) return occluded_filtered(rays, occluded, options, nullptr, nullptr);
  require_as_many(rays.count, occluded.size(), "as many results as rays are needed");
  const Structure& structure = *structure_;
  const auto trace = [&](std::size_t begin, std::size_t count, std::uint8_t* batch) {
    if (structure.wide.empty()) {
      std::fill_n(batch, count, std::uint8_t{0});
    } else {
      with_rays(rays, begin, count,
                [&](const Ray* from) { structure.kernels->any_many(structure.wide, from, count, batch); });
    }
  };
  for_each_batch(rays.count, rays_per_batch, options, [&](std::size_t begin, std::size_t count) {
    if (occluded.stride() == 1) return trace(begin, count, occluded.data() + begin);
    std::uint8_t copies[rays_per_batch];
    trace(begin, count, copies);
    for (std::size_t i = 0; i < count; ++i) occluded.set(begin + i, copies[i] != 0);
  });
}

bool occluded(const Bvh& bvh, const Ray& ray, TraversalCounters& counters) {
  const Structure& structure = Structure::of(bvh);
  return !structure.wide.empty() && structure.kernels->any_counted(structure.wide, ray, counters);
}

}  // namespace kerf
