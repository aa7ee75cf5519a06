// The closest hit: of a ray, of many, and counted.
#include <algorithm>

#include <kerf/bvh.hpp>
#include <kerf/inspect.hpp>

#include "base/raise.hpp"
#include "queries/batches.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

// Kernels number triangles over all meshes; users name them by mesh and primitive.
void name_triangle(const Structure& structure, Hit& hit) {
  const PrimitiveId id = locate(structure, hit.primitive);
  hit.primitive = id.primitive;
  hit.mesh = id.mesh;
}

}  // namespace

std::optional<Hit> Bvh::intersect(const Ray& ray) const {
  std::optional<Hit> hit;
  const Structure& structure = *structure_;
  if (structure.wide.empty()) return hit;
  structure.kernels->closest(structure.wide, ray, hit.emplace());
  if (*hit) {
    name_triangle(structure, *hit);
  } else {
    hit.reset();
  }
  return hit;
}

void Bvh::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
  if (rays.size() != hits.size()) raise(Error::invalid_argument, "as many hits as rays are needed");
  const Structure& structure = *structure_;
  if (structure.wide.empty()) {
    std::fill(hits.begin(), hits.end(), Hit{});
    return;
  }
  for_each_batch(rays.size(), [&](std::size_t begin, std::size_t count) {
    structure.kernels->closest_many(structure.wide, rays.data() + begin, count, hits.data() + begin);
    for (Hit& hit : hits.subspan(begin, count)) {
      if (hit) {
        name_triangle(structure, hit);
      } else {
        hit = {};
      }
    }
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
