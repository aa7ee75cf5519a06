// Whether a tree is valid, for tests and for tools.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// One sentence for each violation, at most `max_findings`; none if `tree` is valid:
/// - children come after their parent, side by side and inside its box; every node but the root has one
/// parent;
/// - every reference is in one leaf and names a triangle of `geometry`; no leaf names a triangle twice;
/// - no leaf is deeper than `max_depth` or has more references than `max_leaf_size`;
/// - the boxes of the leaves that reference a triangle cover it completely, if it has an area.
std::vector<std::string> validate(const BinaryTree& tree, const Geometry& geometry,
                                  std::size_t max_depth = 64, std::size_t max_leaf_size = 8,
                                  std::size_t max_findings = 20);

}  // namespace kerf
