// From a binary tree to a wide one: which binary nodes become the children of a wide node, and which a leaf.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <hwy/cache_control.h>

#include "base/uninitialized.hpp"
#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {

/// What traversal costs, in visits of a wide node.
struct CollapseCosts {
  float leaf = 0.4f;       ///< to enter a leaf
  float triangle = 0.03f;  ///< on top, for each of its triangles, which are tested together
};

/// D(n, i) of `Collapse` and the k that gives it (of several, the lowest) for all i = 1 .. w at once, with k
/// up to some maximum: element i - 1 is the minimum of C(left, k) + C(right, i - k). D(n, 1) is infinite.
struct Distribution {
  alignas(64) float cost[max_node_width];
  alignas(64) std::int32_t left_share[max_node_width];
};

/// Computes `to` of the costs of both children; k is at most `max_share`.
using Distribute = void(const float* left, std::int32_t max_share, const float* right, Distribution& to);
Distribute& distribute(std::uint32_t width, Target target);

/// The cost-optimal way to cut a binary tree into nodes of up to w children (Ylitie, Karras & Laine
/// 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3).
///
/// With C(n, i) the minimum cost of the subtree n when it takes up to i slots of a wide node, and A(n) half
/// the area of its box or, where the tree knows them, its expected visits,
///
///     C(n, 1) = min(leaf, A(n) + D(n, w))           one child: a leaf or a wide node
///     C(n, i) = min(D(n, i), C(n, i - 1))           2 <= i < w
///     D(n, i) = min over k of C(left, k) + C(right, i - k)
///
/// Only its parent needs the costs of a node. What is kept are the decisions, which minimum was taken: eight
/// bytes per node.
class Collapse {
 public:
  /// On all threads of the task arena that this is called in. `tree` must outlive this.
  /// Of nodes of `width` (w above) children: 16, 8 or 4.
  Collapse(const BinaryTree& tree, std::uint32_t width, const CollapseCosts& costs = {},
           Target target = choose_target());

  /// The binary nodes that are the children of the wide node of `node`, in the tree's order.
  struct Children {
    std::array<std::uint32_t, max_node_width> node;
    std::uint32_t count = 0;
  };
  Children children(std::uint32_t node) const;

  /// Fetches what `children` reads first.
  void prefetch(std::uint32_t node) const {
    hwy::Prefetch(&decisions_[node]);
    hwy::Prefetch(&tree_->nodes[node]);
  }

  /// Whether the binary node, a child of a wide one, becomes a leaf.
  bool is_leaf(std::uint32_t node) const { return (decisions_[node] & leaf_bit) != 0; }

  /// How many references are below the node, or `wide_leaf_triangles + 1` if there are more than fit into a
  /// leaf.
  std::uint32_t few_references(std::uint32_t node) const {
    return static_cast<std::uint32_t>(decisions_[node] >> few_shift);
  }

  /// Whether at least `2^(bits - 1)` references are below the node.
  bool is_large(std::uint32_t node, std::uint32_t bits) const {
    return ((decisions_[node] >> size_shift) & 63u) >= bits;
  }

  /// The memory for a tree of that many nodes.
  static constexpr std::size_t bytes(std::size_t nodes) { return nodes * sizeof(std::uint64_t); }

 private:
  // One word per node:
  //
  //     bit 63..60          59..54           53           48..45  ...  2..1    0
  //     references,         bit width of     C(n, 1)      k of            k of    k of
  //     9 for more          their count      is a leaf    D(n, 16)        D(n, 3) D(n, 2)
  //
  // A k of 0 says that C(n, i) = C(n, i - 1). Since k < i, it has std::bit_width(i - 1) bits. In narrower
  // nodes the upper ones are not used.
  static constexpr std::uint64_t leaf_bit = std::uint64_t{1} << 53;
  static constexpr std::uint32_t size_shift = 54, few_shift = 60;

  struct Costs;
  static std::uint64_t size_bits(std::uint32_t references);
  void solve(std::uint32_t node, std::uint32_t end, Costs& costs);
  void solve_leaf(std::uint32_t node, Costs& costs);
  void combine(std::uint32_t node, const Costs& left, const Costs& right, Costs& costs);
  void expand(std::uint32_t node, std::uint32_t i, Children& children) const;

  float visits(std::uint32_t node) const {
    return tree_->visits.empty() ? half_area(tree_->nodes[node].bounds) : tree_->visits[node];
  }

  const BinaryTree* tree_;
  CollapseCosts costs_;
  Distribute& distribute_;
  std::uint32_t width_;
  UninitializedVector<std::uint64_t> decisions_;
};

}  // namespace kerf
