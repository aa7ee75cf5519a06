// Splitting triangles before the build, the two ways that the seed paper compares spatial splits with (Stich,
// Friedrich & Dietrich 2009, sections 2 and 5). Both yield references for a builder of object splits.
#pragma once

#include <cstddef>
#include <vector>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Early split clipping (Ernst & Greiner 2007, "Early Split Clipping for Bounding Volume Hierarchies"): a box
/// with a surface area above a threshold is cut at the middle of its longest axis, its triangle clipped to
/// both halves, and so on with these.
///
/// `references` are whole triangles of `geometry`. Makes as many references as the smallest threshold allows
/// under which there are no more than `limit`; that threshold is found by bisection.
std::vector<Reference> split_by_area(const Geometry& geometry, std::vector<Reference> references,
                                     std::size_t limit);

/// The edge volume heuristic (Dammertz & Keller 2008, "The Edge Volume Heuristic: Robust Triangle Subdivision
/// for Improved BVH Performance"): while the axis-aligned box of an edge of the triangle has a volume above a
/// threshold, the triangle is cut in two at the middle of the edge with the largest. As above otherwise.
std::vector<Reference> split_by_edge_volume(const Geometry& geometry, std::vector<Reference> references,
                                            std::size_t limit);

/// Where several parts of a triangle came to the same leaf, keeps one: a leaf tests whole triangles.
void merge_parts_in_leaves(BinaryTree& tree);

}  // namespace kerf
