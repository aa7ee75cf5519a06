// The closest hit: of a ray, of many, and counted.
#include <algorithm>
#include <span>

#include <kerf/bvh.hpp>
#include <kerf/inspect.hpp>

#include "queries/batches.hpp"
#include "queries/ray_columns.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {

bool Bvh::intersect(const Ray& ray, Hit& hit) const {
  const Structure& structure = *structure_;
  if (structure.wide.empty()) {
    hit = {};
    return false;
  }
  structure.kernels->closest(structure.wide, ray, hit);
  if (!hit) return false;
  name_triangle(structure, hit);
  return true;
}

std::optional<Hit> Bvh::intersect(const Ray& ray) const {
  std::optional<Hit> hit;
  if (!intersect(ray, hit.emplace())) hit.reset();
  return hit;
}

void Bvh::intersect(const RayView& rays, const HitView& hits, const BatchOptions& options) const {
  if (rays.mask.data != nullptr) return intersect_filtered(rays, hits, options, nullptr, nullptr);
  require_as_many(rays.count, hits.count, "as many hits as rays are needed");
  const Structure& structure = *structure_;
  const auto trace = [&](std::size_t begin, std::size_t count, Hit* batch) {
    if (structure.wide.empty()) {
      std::fill_n(batch, count, Hit{});
      return;
    }
    with_rays(rays, begin, count,
              [&](const Ray* from) { structure.kernels->closest_many(structure.wide, from, count, batch); });
    for (Hit& hit : std::span(batch, count)) {
      if (hit) {
        name_triangle(structure, hit);
      } else {
        hit = {};
      }
    }
  };
  Hit* const array = as_array(hits);
  for_each_batch(rays.count, rays_per_batch, options, [&](std::size_t begin, std::size_t count) {
    if (array != nullptr) return trace(begin, count, array + begin);
    Hit copies[rays_per_batch];  // only here: to fill them takes longer than to trace a ray
    trace(begin, count, copies);
    for (std::size_t i = 0; i < count; ++i) write_hit(hits, begin + i, copies[i]);
  });
}

std::optional<Hit> intersect(const Bvh& bvh, const Ray& ray, TraversalCounters& counters) {
  const Structure& structure = Structure::of(bvh);
  if (structure.wide.empty()) return std::nullopt;
  Hit hit = structure.kernels->closest_counted(structure.wide, ray, counters);
  if (!hit) return std::nullopt;
  name_triangle(structure, hit);
  return hit;
}

}  // namespace kerf
