// Leaf count variability: how much the number of leaves differs that lines through a tree meet.
#pragma once

#include "tree/binary_tree.hpp"

namespace kerf {

/// The standard deviation of the number of leaves whose boxes a line through the root's box meets (Aila,
/// Karras & Laine 2013, section 5). The lines are those of the surface area heuristic: their starting points
/// are uniform on the root's surface and their directions have the cosine distribution. A fixed
/// low-discrepancy sequence of 2^16 lines stands for all, so that the value is the same on each run; its
/// beginning alone, where lines meet so many nodes that all would take too long. 0 for an empty tree.
double leaf_count_variability(const BinaryTree& tree);

}  // namespace kerf
