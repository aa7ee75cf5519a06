// How often the nodes of a tree will be visited.
#pragma once

#include <span>

#include <kerf/ray.hpp>

#include "tree/binary_tree.hpp"

namespace kerf {

/// Sets `BinaryTree::visits` to how often each node is visited by rays whose ways are like `ways`: what was
/// counted, and where few were counted, the ratio of areas. With v the visits, c the counts, A the areas and
/// m = 8 rays that are taken as if they had gone everywhere:
///
///     v(root) = c(root) + m
///     v(child) = v(node) * (c(child) + m * A(child) / A(node)) / (c(node) + m)
///
/// On all threads of the task arena that this is called in.
void expect_visits(BinaryTree& tree, std::span<const Ray> ways);

}  // namespace kerf
