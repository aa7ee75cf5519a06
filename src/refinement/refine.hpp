// From a tree to a better one.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include <kerf/build.hpp>
#include <kerf/ray.hpp>

#include "tree/binary_tree.hpp"

namespace kerf {

/// Improves `tree` as `options.quality` asks, for rays of all kinds or, if there are
/// any, for those whose ways are like `ways`, on `options.threads` threads.
/// Same leaves, same references. Calls `progress`, which may be empty, with a fraction in [0, 1] that never
/// falls; throws `Error::cancelled` after a false.
void refine(BinaryTree& tree, std::span<const Ray> ways, const BuildOptions& options,
            const std::function<bool(float)>& progress);

/// An upper bound of the bytes held while a tree of so many references is refined for so many ways, both
/// included.
std::size_t refinement_memory_bound(std::size_t references, std::size_t ways, const BuildOptions& options);

}  // namespace kerf
