// The builders, in one table. A new one is a file beside the others and a line of the table in builders.cpp.
#pragma once

#include <cstddef>

#include <kerf/build.hpp>
#include <kerf/inspect.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// Builds a tree over all triangles of `geometry`. `options` have been checked. Throws as `kerf::build` does,
/// but where memory runs out it throws `std::bad_alloc`.
using Construct = BinaryTree(const Geometry& geometry, const BuildOptions& options);

/// No build of so many triangles holds more memory before its tree is finished, the tree included.
using MemoryBound = std::size_t(std::size_t triangles, const BuildOptions& options);

struct BuilderEntry {
  BuilderInfo info;
  Construct* construct;
  MemoryBound* memory_bound;
};

/// The entry of `builder`; null if the table has none.
const BuilderEntry* find_builder(Builder builder);

}  // namespace kerf
