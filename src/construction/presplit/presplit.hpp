// Splitting triangles before the build, the two ways that the seed paper compares spatial splits with (Stich,
// Friedrich & Dietrich 2009, sections 2 and 5).
#pragma once

#include <cstddef>
#include <vector>

#include <kerf/build.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Makes references to parts of triangles out of references to whole triangles of `geometry`: as many as the
/// smallest threshold allows under which there are no more than `limit`.
using SplitReferences = std::vector<Reference>(const Geometry& geometry, std::vector<Reference> references,
                                               std::size_t limit);

/// Builds a tree of object splits over the references that `presplit` makes, as many as `options` allow.
BinaryTree construct_presplit(const Geometry& geometry, const BuildOptions& options,
                              SplitReferences* presplit);

}  // namespace kerf
