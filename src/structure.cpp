#include "structure.hpp"

#include "traversal/dispatch.hpp"

namespace kerf {

ChildLink TriangleLeaves::operator()(const WideBvh& bvh, std::size_t triangles, std::uint32_t id) const {
  std::call_once(once_, [&] {
    std::vector<ChildLink> leaves(triangles);
    for_each_leaf(bvh, [&](ChildLink leaf) {
      for (std::uint32_t i = 0; i < leaf.count(); ++i) leaves[triangle_id(bvh, leaf, i)] = leaf;
    });
    leaves_ = std::move(leaves);
  });
  return leaves_[id];
}

std::shared_ptr<Structure> make_structure(WideBvh wide, std::vector<std::uint32_t> first_triangles,
                                          std::size_t degenerate_triangles) {
  auto structure = std::make_shared<Structure>();
  structure->wide = std::move(wide);
  structure->first_triangles = std::move(first_triangles);
  structure->kernels = &choose_kernels();
  BvhStatistics& statistics = structure->statistics;
  statistics.triangles = structure->first_triangles.back();
  statistics.degenerate_triangles = degenerate_triangles;
  statistics.references = structure->wide.references();
  statistics.nodes = structure->wide.node_count;
  statistics.bytes = structure->wide.node_bytes() + structure->wide.leaves.size_bytes();
  return structure;
}

}  // namespace kerf
