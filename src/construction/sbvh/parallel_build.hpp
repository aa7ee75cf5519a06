// The split bounding volume hierarchy (SBVH) of Stich, Friedrich & Dietrich 2009, and as its special case the
// one with object splits only. Built by tasks on many threads.
#pragma once

#include <vector>

#include <kerf/build.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Builds `Builder::sbvh` or, without spatial splits, `Builder::bvh` over all triangles of `geometry`. Throws
/// as `kerf::build` does, but where memory runs out it throws `std::bad_alloc`.
BinaryTree construct_split_tree(const Geometry& geometry, const BuildOptions& options);

/// Builds over `references` by object splits alone, for builders that split before the build. Of `options`,
/// it uses the leaf size, the threads and the progress.
BinaryTree construct_object_split_tree(std::vector<Reference> references, const BuildOptions& options);

/// The number of references that the arena of a build of so many triangles has room for.
std::size_t max_references(std::size_t triangles, const BuildOptions& options);

/// `construct_split_tree` never holds more memory at once, the tree included. These are the arena; the tree,
/// which is a little more than twice as large if every leaf holds a single reference; and the part of
/// finished subtrees that does not fit into the arena.
std::size_t tree_memory_bound(std::size_t triangles, const BuildOptions& options);

}  // namespace kerf
