// The last stage of a build.
#pragma once

#include <memory>

#include "structure.hpp"
#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// Lays `tree` out for traversal, on `threads` threads, 0 for all. Throws `Error::too_large` and
/// `std::bad_alloc`.
std::shared_ptr<Structure> lay_out_tree(const Geometry& geometry, const BinaryTree& tree, unsigned threads);

}  // namespace kerf
