// The front door of the builders.
#pragma once

#include <kerf/build.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// Checks the options and every triangle, then builds the tree that `options.builder` names.
/// Throws as `kerf::build` does.
BinaryTree build_tree(const Geometry& geometry, const BuildOptions& options);

}  // namespace kerf
