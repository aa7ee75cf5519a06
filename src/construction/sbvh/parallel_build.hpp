// The split bounding volume hierarchy of Stich, Friedrich & Dietrich 2009, and the plain one as its special
// case.
#pragma once

#include <vector>

#include <kerf/build.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Builds `Builder::sbvh` or, without spatial splits, `Builder::bvh` over all triangles of `geometry`. Throws
/// as `kerf::build` does, but for memory, when it throws std::bad_alloc.
BinaryTree build_split_tree(const Geometry& geometry, const BuildOptions& options);

/// Builds over `references` by object splits alone: behind pre-splitting. Of `options`, uses the leaf size,
/// the threads and the progress.
BinaryTree build_object_split_tree(std::vector<Reference> references, const BuildOptions& options);

/// The room for references in the arena of a build of so many triangles.
std::size_t most_references(std::size_t triangles, const BuildOptions& options);

/// The most memory that `build_split_tree` can hold at once, the tree included, known before it begins: the
/// arena, and the tree, which where every leaf holds a single reference is a little more than twice as large,
/// and what of that does not fit into the arena.
std::size_t tree_memory_bound(std::size_t triangles, const BuildOptions& options);

}  // namespace kerf
