#include "base/fp_environment.hpp"
#include "queries/crossings.hpp"

namespace kerf {

void Bvh::visit_hits(const Ray& ray, const void* visitor, bool (*visit)(const void*, const Hit&)) const {
  const PlainFloatingPoint plain;
  for_each_crossing(*structure_, ray, [&](std::uint32_t id, Hit hit) {
    const PrimitiveId place = locate(*structure_, id);
    hit.primitive = place.primitive;
    hit.mesh = place.mesh;
    return visit(visitor, hit);
  });
}

std::size_t Bvh::all_hits(const Ray& ray, std::span<Hit> hits) const {
  std::size_t count = 0;
  all_hits(ray, [&](const Hit& hit) {
    if (count < hits.size()) hits[count] = hit;
    ++count;
  });
  return count;
}

}  // namespace kerf
