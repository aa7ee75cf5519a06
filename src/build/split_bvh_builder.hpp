// The split bounding volume hierarchy of Stich, Friedrich & Dietrich 2009, and the plain one as its special
// case.
#pragma once

#include <kerf/build.hpp>
#include <vector>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Builds over `references` by object splits alone: for `Builder::bvh`, and behind pre-splitting. Of
/// `options`, uses the leaf size, the threads and the progress.
BinaryTree build_object_split_tree(std::vector<Reference> references, const BuildOptions& options);

/// Builds by object and spatial splits; `references` are whole triangles of `geometry`.
BinaryTree build_split_tree(const Geometry& geometry, std::vector<Reference> references,
                            const BuildOptions& options);

}  // namespace kerf
