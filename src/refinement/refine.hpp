// From a tree to a better one.
#pragma once

#include <cstddef>
#include <functional>

#include <kerf/build.hpp>

#include "tree/binary_tree.hpp"

namespace kerf {

/// Improves `tree` as `options.quality`, which is not `fast`, asks, on `options.threads` threads. Same
/// leaves, same references. Calls `progress`, which may be empty, with a fraction in [0, 1] that never falls;
/// throws `Error::cancelled` after a false.
void refine(BinaryTree& tree, const BuildOptions& options, const std::function<bool(float)>& progress);

/// An upper bound of the bytes held while a tree of so many references is refined, the tree included.
std::size_t refinement_memory_bound(std::size_t references, const BuildOptions& options);

}  // namespace kerf
