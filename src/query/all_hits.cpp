#include "query/crossings.hpp"

namespace kerf {
namespace {

Hit named(const TreeView& tree, std::uint32_t id, Hit hit) {
  const PrimitiveId place = tree.locate(id);
  hit.primitive = place.primitive;
  hit.mesh = place.mesh;
  return hit;
}

}  // namespace

void Bvh::visit_hits(const Ray& ray, const void* visitor, bool (*visit)(const void*, const Hit&)) const {
  const TreeView tree(*structure_);
  for_each_crossing(tree, ray,
                    [&](std::uint32_t id, const Hit& hit) { return visit(visitor, named(tree, id, hit)); });
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
