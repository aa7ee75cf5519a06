// From a binary tree to the structure that rays are traced through.
#pragma once

#include "kernel/wide_bvh.hpp"
#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// Collapses `tree` and lays the result out. A triangle that stands twice below one wide leaf is stored once.
/// Throws `Error::too_large` for more references than a `ChildLink` can number, and `std::bad_alloc`.
WideBvh make_wide_bvh(const Geometry& geometry, const BinaryTree& tree);

}  // namespace kerf
