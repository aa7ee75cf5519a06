// Whether a tree is whole: for tests and for tools that look at what a builder made.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// What is broken in `tree`, a sentence each; nothing if it is whole:
/// - children come after their parent, side by side and inside its box; every node has one parent but the
/// root;
/// - every reference is in one leaf and names a triangle of `geometry`; no leaf names one twice;
/// - no leaf is deeper than `max_depth`, nor has more references than `max_leaf_size`;
/// - every triangle that has an area is covered, every part of it, by the boxes of the leaves that reference
/// it. Stops looking after `max_findings`.
std::vector<std::string> validate(const BinaryTree& tree, const Geometry& geometry,
                                  std::size_t max_depth = 64, std::size_t max_leaf_size = 8,
                                  std::size_t max_findings = 20);

}  // namespace kerf
