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

/// The most memory that a build of `triangles` triangles can hold at once, its tree included, known before it
/// begins: the arena, what each thread works in, and the tree, which where every leaf holds a single
/// reference is twice as large as the arena and stands once more where it does not fit into that.
std::size_t build_memory_bound(std::size_t triangles, const BuildOptions& options);

}  // namespace kerf
