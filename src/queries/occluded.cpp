// Whether anything is hit: of a ray, of many, and counted.
#include <algorithm>

#include <kerf/bvh.hpp>
#include <kerf/inspect.hpp>

#include "base/raise.hpp"
#include "queries/batches.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {

bool Bvh::occluded(const Ray& ray) const {
  const Structure& structure = *structure_;
  return !structure.wide.empty() && structure.kernels->any(structure.wide, ray);
}

void Bvh::occluded(std::span<const Ray> rays, std::span<std::uint8_t> occluded) const {
  if (rays.size() != occluded.size()) raise(Error::invalid_argument, "as many results as rays are needed");
  const Structure& structure = *structure_;
  if (structure.wide.empty()) {
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    return;
  }
  for_each_batch(rays.size(), [&](std::size_t begin, std::size_t count) {
    structure.kernels->any_many(structure.wide, rays.data() + begin, count, occluded.data() + begin);
  });
}

bool occluded(const Bvh& bvh, const Ray& ray, TraversalCounters& counters) {
  const Structure& structure = Structure::of(bvh);
  return !structure.wide.empty() && structure.kernels->any_counted(structure.wide, ray, counters);
}

}  // namespace kerf
