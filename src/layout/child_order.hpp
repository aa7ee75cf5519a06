// The order in which any-hit traversal visits the children of a node.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "layout/collapse.hpp"
#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {

/// What any-hit traversal may expect of a subtree whose box the ray enters.
struct Prospect {
  float hit;    ///< the probability of a hit
  float steps;  ///< the cost of searching all of it
};

Prospect prospect_of_leaf(std::uint32_t triangles);

/// Puts the children of a node, whose links are in their order, into the order in which any-hit traversal
/// visits them, the first one in the last slot: by the probability of a hit per cost. That order is
/// optimal if the children are independent (as for shadow rays in Ize & Hansen 2011, "RTSAH Traversal Order
/// for Occlusion Rays"). Then writes what `write_children` does, and returns the prospect of the node.
template <std::uint32_t width>
Prospect arrange(Target target, std::span<const BinaryNode* const> children,
                 const std::array<Prospect, max_node_width>& prospects, WideNode<width>& node);

/// The same for the children that a binary tree collapses to.
template <std::uint32_t width>
Prospect arrange(Target target, const BinaryTree& tree, const Collapse::Children& children,
                 const std::array<Prospect, max_node_width>& prospects, WideNode<width>& node) {
  std::array<const BinaryNode*, width> binaries;
  for (std::uint32_t child = 0; child < children.count; ++child)
    binaries[child] = &tree.nodes[children.node[child]];
  return arrange(target, {binaries.data(), children.count}, prospects, node);
}

}  // namespace kerf
