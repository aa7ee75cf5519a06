#include "build/build_tree.hpp"

#include <utility>

#include "build/input.hpp"
#include "build/split_bvh_builder.hpp"

namespace kerf {

BinaryTree build_tree(const Geometry& geometry, const BuildOptions& options) {
  check_options(options);
  Input input = make_references(geometry);
  BinaryTree tree;
  switch (options.builder) {
    case Builder::sbvh:
      tree = build_split_tree(geometry, std::move(input.references), options);
      break;
    case Builder::bvh:
    case Builder::esc:
    case Builder::evh:
      tree = build_object_split_tree(std::move(input.references), options);
      break;
  }
  tree.degenerate_triangles = input.degenerate_triangles;
  return tree;
}

}  // namespace kerf
