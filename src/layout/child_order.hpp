// The order in which a ray that looks for any hit takes the children of a node.
#pragma once

#include <array>

#include "layout/collapse.hpp"
#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {

/// What such a ray may expect of a subtree whose box it enters.
struct Prospect {
  float hit;    ///< how likely it finds one
  float steps;  ///< what it costs to look through all of it
};

Prospect prospect_of_leaf(std::uint32_t triangles);

/// Puts the children of a node into the order in which any-hit traversal takes them, the first into the last
/// slot: that with the most chance of a hit for its cost, which is the best order there is if neither tells
/// anything of the others (as for shadow rays in Ize & Hansen 2011, "RTSAH Traversal Order for Occlusion
/// Rays"). Their links stand in the tree's order. Then writes what `write_children` does, and returns the
/// prospect of the node.
Prospect arrange(Target target, const BinaryTree& tree, const Collapse::Children& children,
                 const std::array<Prospect, wide_node_children>& prospects, WideNode& node);

}  // namespace kerf
