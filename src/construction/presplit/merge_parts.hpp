// What leaves do with several parts of one triangle.
#pragma once

#include "tree/binary_tree.hpp"

namespace kerf {

/// Where several parts of a triangle came to the same leaf, keeps one reference: a leaf tests whole
/// triangles.
void merge_parts_in_leaves(BinaryTree& tree);

}  // namespace kerf
