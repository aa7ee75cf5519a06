#include "support/node_width.hpp"

#include <memory>
#include <utility>

#include "build.hpp"
#include "layout/change_width.hpp"
#include "layout/lay_out.hpp"
#include "structure.hpp"

namespace kerf_tests {

kerf::Bvh with_node_width(const kerf::Bvh& bvh, std::uint32_t width) {
  auto changed = std::make_shared<kerf::Structure>(kerf::Structure::of(bvh));
  changed->wide = kerf::change_width(changed->wide, changed->statistics.triangles, width);
  return kerf::Structure::share(std::move(changed));
}

kerf::Bvh build_with_node_width(const kerf::TriangleMesh& mesh, const kerf::BuildOptions& options,
                                std::uint32_t width) {
  const kerf::Geometry geometry(std::span(&mesh, 1));
  const kerf::BinaryTree tree = kerf::make_tree(geometry, options);
  const auto first = geometry.first_triangles();
  return kerf::Structure::share(kerf::make_structure(kerf::make_wide_bvh(geometry, tree, width).wide,
                                                     {first.begin(), first.end()},
                                                     tree.degenerate_triangles));
}

}  // namespace kerf_tests
