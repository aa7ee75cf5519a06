// The front door of the builders.
#pragma once

#include <kerf/build.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// Checks the options and every triangle, then builds the tree with the builder that `options` name. Throws
/// as `kerf::build` does, but where memory runs out it throws `std::bad_alloc`.
BinaryTree construct(const Geometry& geometry, const BuildOptions& options);

}  // namespace kerf
