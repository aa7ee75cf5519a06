// How good a tree is: what it holds, and what a ray can be expected to do in it.
#pragma once

#include <kerf/inspect.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

TreeCounts count_tree(const BinaryTree& tree);

/// The surface area heuristic: (1.2 * sum of A(inner) + 1.0 * sum of A(leaf) * references(leaf)) / A(root),
/// the cost of a random line through the whole root. 0 for an empty tree or a root without area.
double surface_area_cost(const BinaryTree& tree);

/// End-point overlap (Aila et al. 2013, section 4): the cost, over a random point of the surface, of the
/// nodes whose boxes hold the point though what is under them has no part in it,
///
///     EPO = 1 / A(S) * sum over nodes n of cost(n) * A(S in box(n), without the triangles of n's subtree),
///
/// where cost is 1.2 for an inner node and 1.0 a reference for a leaf, and the surface S is that of all
/// triangles that the tree references. A triangle belongs to a subtree if any leaf under it references the
/// triangle. Where splits put parts of a triangle into several leaves, a part of it that lies in the box of a
/// node but in another node's leaf is thus no overlap: a ray that ends there may find the triangle in either.
/// The measure is then the same function of boxes and references for every builder, and for trees without
/// splits exactly the paper's.
double end_point_overlap(const BinaryTree& tree, const Geometry& geometry);

/// Leaf count variability (Aila et al. 2013, section 5): the standard deviation of the number of leaves whose
/// boxes a line through the root's box meets. The lines are those of the surface area heuristic, distributed
/// evenly (from points even on the root's surface, with the cosine's distribution of directions); a fixed
/// low-discrepancy sequence of 2^16 of them stands for all, so that the value is the same on each run.
double leaf_count_variability(const BinaryTree& tree);

}  // namespace kerf
