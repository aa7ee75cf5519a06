// From a binary tree to the layout that is traversed.
#pragma once

#include <cstddef>

#include "layout/wide_bvh.hpp"
#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

struct LaidOut {
  WideBvh wide;
  std::size_t peak_bytes = 0;  ///< the largest amount of memory held at a time, `wide` included
};

/// Collapses `tree` to nodes of `width` children (16, 8 or 4) and lays the result out, on all threads of the
/// task arena that this is called in. A triangle with several references in one wide leaf is stored once.
/// Throws `Error::too_large` for more references than a `ChildLink` can number, and `std::bad_alloc`.
LaidOut make_wide_bvh(const Geometry& geometry, const BinaryTree& tree, std::uint32_t width);

/// An upper bound of `peak_bytes` for trees of so many references.
std::size_t layout_memory_bound(std::size_t references);

}  // namespace kerf
