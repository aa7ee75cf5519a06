// The edge volume heuristic (Dammertz & Keller 2008, "The Edge Volume Heuristic: Robust Triangle Subdivision
// for Improved BVH Performance").
#pragma once

#include "construction/presplit/presplit.hpp"

namespace kerf {

/// The `SplitReferences` of the edge volume heuristic: while the axis-aligned box of an edge of the triangle
/// has a volume above the threshold, the triangle is cut in two at the middle of the edge with the largest
/// volume.
std::vector<Reference> split_by_edge_volume(const Geometry& geometry, std::vector<Reference> references,
                                            std::size_t limit);

/// The builder.
BinaryTree construct_evh(const Geometry& geometry, const BuildOptions& options);

}  // namespace kerf
