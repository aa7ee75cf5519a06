// Early split clipping (Ernst & Greiner 2007, "Early Split Clipping for Bounding Volume Hierarchies").
#pragma once

#include "construction/presplit/presplit.hpp"

namespace kerf {

/// The `SplitReferences` of early split clipping: a box with a surface area above the threshold is cut at the
/// middle of its longest axis, its triangle is clipped to both halves, and these are cut in turn.
std::vector<Reference> split_by_area(const Geometry& geometry, std::vector<Reference> references,
                                     std::size_t limit);

/// The builder.
BinaryTree construct_esc(const Geometry& geometry, const BuildOptions& options);

}  // namespace kerf
