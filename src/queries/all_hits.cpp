// Every crossing of a ray: in order, into memory, and counted; of one ray and of many.
#include <algorithm>

#include <kerf/bvh.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "queries/batches.hpp"
#include "queries/ray_columns.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

Hit hit_of(const Structure& structure, const Crossing& crossing) {
  const PrimitiveId id = locate(structure, crossing.id);
  return {.t = crossing.t, .u = crossing.u, .v = crossing.v, .primitive = id.primitive, .mesh = id.mesh};
}

// Makes `found` the crossings of the ray, each once and in order.
void list_crossings(const Structure& structure, const Ray& ray, Crossings& found) {
  found.truncate(0);
  if (structure.wide.empty()) return;
  structure.kernels->find_crossings(structure.wide, ray, found);
  sort_crossings({found.begin(), found.size()});
  const auto same = [](const Crossing& a, const Crossing& b) { return a.id == b.id; };
  found.truncate(static_cast<std::size_t>(std::unique(found.begin(), found.end(), same) - found.begin()));
}

std::size_t count_crossings(const Structure& structure, const Ray& ray) {
  return structure.wide.empty() ? 0 : structure.kernels->count_crossings(structure.wide, ray);
}

}  // namespace

void Bvh::visit_hits(const Ray& ray, const void* visitor, bool (*visit)(const void*, const Hit&)) const {
  const PlainFloatingPoint plain;
  const Structure& structure = *structure_;
  if (structure.wide.empty()) return;
  auto call = [&](const Crossing& crossing) { return visit(visitor, hit_of(structure, crossing)); };
  using Call = decltype(call);
  structure.kernels->visit_crossings(structure.wide, ray, &call, [](void* caller, const Crossing& crossing) {
    return (*static_cast<Call*>(caller))(crossing);
  });
}

std::size_t Bvh::all_hits(const Ray& ray, std::span<Hit> hits) const {
  if (hits.empty()) return count_hits(ray);
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    Crossings found;
    list_crossings(*structure_, ray, found);
    const std::size_t count = std::min(found.size(), hits.size());
    for (std::size_t i = 0; i < count; ++i) hits[i] = hit_of(*structure_, found.begin()[i]);
    return found.size();
  });
}

std::size_t Bvh::count_hits(const Ray& ray) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] { return count_crossings(*structure_, ray); });
}

void Bvh::count_hits(const RayView& rays, std::span<std::uint32_t> counts,
                     const BatchOptions& options) const {
  require_as_many(rays.count, counts.size(), "as many counts as rays are needed");
  for_each_batch(rays.count, points_per_batch, options, [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i)
      counts[i] = static_cast<std::uint32_t>(count_crossings(*structure_, ray_at(rays, i)));
  });
}

Lists<Hit> Bvh::all_hits(const RayView& rays, const BatchOptions& options) const {
  return list_in_batches<Hit>(rays.count, points_per_batch, options,
                              [&](std::size_t i, std::vector<Hit>& hits) {
                                Crossings found;
                                list_crossings(*structure_, ray_at(rays, i), found);
                                for (const Crossing& crossing : found)
                                  hits.push_back(hit_of(*structure_, crossing));
                              });
}

void Bvh::all_hits(const RayView& rays, std::span<const std::size_t> offsets, std::span<Hit> hits,
                   const BatchOptions& options) const {
  require_as_many(rays.count + 1, offsets.size(), "one more offset than rays is needed");
  if (!std::is_sorted(offsets.begin(), offsets.end()) || offsets.back() > hits.size())
    raise(Error::invalid_argument, "offsets must ascend and end within the hits");
  for_each_batch(rays.count, points_per_batch, options, [&](std::size_t begin, std::size_t count) {
    Crossings found;
    for (std::size_t i = begin; i < begin + count; ++i) {
      list_crossings(*structure_, ray_at(rays, i), found);
      const std::span<Hit> to = hits.subspan(offsets[i], offsets[i + 1] - offsets[i]);
      const std::size_t fit = std::min(found.size(), to.size());
      for (std::size_t k = 0; k < fit; ++k) to[k] = hit_of(*structure_, found.begin()[k]);
      std::fill(to.begin() + static_cast<std::ptrdiff_t>(fit), to.end(), Hit{});
    }
  });
}

}  // namespace kerf
