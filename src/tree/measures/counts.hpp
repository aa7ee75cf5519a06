// What a tree holds.
#pragma once

#include <kerf/inspect.hpp>

#include "tree/binary_tree.hpp"

namespace kerf {

TreeCounts count_tree(const BinaryTree& tree);

}  // namespace kerf
