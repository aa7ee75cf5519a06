// The stages of a build.
#pragma once

#include <memory>

#include <kerf/build.hpp>

#include "structure.hpp"
#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// Checks the options and every triangle, builds the tree and refines it as `options` ask. Throws as
/// `kerf::build` does, but where memory runs out it throws `std::bad_alloc`.
BinaryTree make_tree(const Geometry& geometry, const BuildOptions& options);

/// Lays `tree` out for traversal, on `threads` threads, 0 for all. Throws `Error::too_large` and
/// `std::bad_alloc`.
std::shared_ptr<Structure> lay_out_tree(const Geometry& geometry, const BinaryTree& tree, unsigned threads);

}  // namespace kerf
