#include "construction/presplit/presplit.hpp"

#include <utility>

#include "construction/input.hpp"
#include "construction/presplit/merge_parts.hpp"
#include "construction/sbvh/parallel_build.hpp"

namespace kerf {
namespace {

std::size_t reference_limit(const BuildOptions& options, std::size_t triangles) {
  if (options.presplit_references != 0) return options.presplit_references;
  return static_cast<std::size_t>(static_cast<double>(options.max_reference_ratio) *
                                  static_cast<double>(triangles));
}

}  // namespace

BinaryTree construct_presplit(const Geometry& geometry, const BuildOptions& options,
                              SplitReferences* presplit) {
  Input input = make_references(geometry, options.non_finite);
  const std::size_t limit = reference_limit(options, input.references.size());
  BinaryTree tree =
      construct_object_split_tree(presplit(geometry, std::move(input.references), limit), options);
  merge_parts_in_leaves(tree);
  tree.degenerate_triangles = input.degenerate_triangles;
  tree.non_finite_triangles = input.non_finite_triangles;
  return tree;
}

}  // namespace kerf
