#include "structure.hpp"

#include "traversal/dispatch.hpp"

namespace kerf {

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
