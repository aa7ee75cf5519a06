#include "construction/construct.hpp"

#include <utility>

#include "construction/input.hpp"
#include "construction/presplit/presplit.hpp"
#include "construction/sbvh/parallel_build.hpp"

namespace kerf {
namespace {

std::size_t presplit_limit(const BuildOptions& options, std::size_t triangles) {
  if (options.presplit_references != 0) return options.presplit_references;
  return static_cast<std::size_t>(static_cast<double>(options.max_reference_ratio) *
                                  static_cast<double>(triangles));
}

}  // namespace

BinaryTree build_tree(const Geometry& geometry, const BuildOptions& options) {
  check_options(options);
  if (options.builder == Builder::sbvh || options.builder == Builder::bvh)
    return build_split_tree(geometry, options);

  Input input = make_references(geometry);
  const std::size_t limit = presplit_limit(options, input.references.size());
  BinaryTree tree = build_object_split_tree(
      options.builder == Builder::esc ? split_by_area(geometry, std::move(input.references), limit)
                                      : split_by_edge_volume(geometry, std::move(input.references), limit),
      options);
  merge_parts_in_leaves(tree);
  tree.degenerate_triangles = input.degenerate_triangles;
  return tree;
}

}  // namespace kerf
