#include "out_of_memory.hpp"
#include "query/subtrees.hpp"
#include "query/triangle_box.hpp"

namespace kerf {

std::vector<PrimitiveId> Bvh::triangles_in(const Box3f& box) const {
  const TreeView tree(*structure_);
  const Box3f finite =
      kerf::intersect(box, tree.bounds());  // infinite ends are of no use to exact arithmetic
  std::vector<PrimitiveId> places;
  if (finite.empty()) return places;
  report_out_of_memory([&] {
    std::vector<std::uint32_t> ids;
    for_each_leaf(
        tree, [&](const Box3f& node) { return !kerf::intersect(node, finite).empty(); },
        [&](std::uint32_t id, const Triangle& triangle) {
          if (overlaps(triangle, finite)) ids.push_back(id);
        });
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    places.reserve(ids.size());
    for (const std::uint32_t id : ids) places.push_back(tree.locate(id));
  });
  return places;
}

}  // namespace kerf
