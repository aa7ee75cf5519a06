// The surface area heuristic: the cost of a random line through a tree. <kerf/inspect.hpp> has the formula
// and its constants.
#pragma once

#include <kerf/inspect.hpp>

#include "tree/binary_tree.hpp"

namespace kerf {

/// 0 for an empty tree or a root without area.
double surface_area_cost(const BinaryTree& tree);

}  // namespace kerf
