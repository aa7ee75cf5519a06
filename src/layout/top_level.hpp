// Nodes over boxes of anything.
#pragma once

#include <cstdint>
#include <vector>

#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {

/// A hierarchy over numbered boxes. Its leaves are places in `numbers`.
struct TopLevel {
  WideBvh nodes;
  std::vector<std::uint32_t> numbers;
};

/// Collapses `tree` to nodes of `width` children, with one reference to a leaf where that is cheaper: what is
/// in a box costs about as much as ten nodes. Throws `std::bad_alloc`.
TopLevel make_top_level(const BinaryTree& tree, std::uint32_t width, Target target);

}  // namespace kerf
