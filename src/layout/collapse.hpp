// From a binary tree to a wide one: which binary nodes become the children of a wide node, and which a leaf.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <hwy/cache_control.h>

#include "base/aligned_array.hpp"
#include "simd/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {

/// What traversal pays on the machine at hand, in visits of a wide node.
struct CollapseCosts {
  float leaf = 0.4f;       ///< to come to a leaf
  float triangle = 0.03f;  ///< more for each of its triangles, which are tested together
};

/// The cost-optimal way to cut a binary tree into nodes of up to sixteen children (Ylitie, Karras & Laine
/// 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3).
///
/// With C(n, i) the least cost of the subtree n when it stands for up to i children of some wide node,
///
///     C(n, 1) = min(leaf, A(n) + D(n, 16))          one child: a leaf or a wide node
///     C(n, i) = min(D(n, i), C(n, i - 1))           2 <= i <= 15
///     D(n, i) = min over k of C(left, k) + C(right, i - k)
///
/// A node's costs are needed by its parent alone, so that what is kept of them is which minimum was taken:
/// eight bytes a node.
class Collapse {
 public:
  /// On all threads of the task arena that this is called in. `tree` must outlive this.
  explicit Collapse(const BinaryTree& tree, const CollapseCosts& costs = {}, Target target = choose_target());

  static constexpr std::uint32_t slots = 16;

  /// The binary nodes that are the children of the wide node of `node`, in the tree's order.
  struct Children {
    std::array<std::uint32_t, slots> node;
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

  /// How many references stand below the node, or more than eight if there are more.
  std::uint32_t few_references(std::uint32_t node) const {
    return static_cast<std::uint32_t>(decisions_[node] >> few_shift);
  }

  /// Whether at least `2^(bits - 1)` references stand below the node.
  bool is_large(std::uint32_t node, std::uint32_t bits) const {
    return ((decisions_[node] >> size_shift) & 63u) >= bits;
  }

  /// What is held for a tree of that many nodes.
  static constexpr std::size_t bytes(std::size_t nodes) { return nodes * sizeof(std::uint64_t); }

 private:
  // One word a node:
  //
  //     bit 63..60          59..54           53           48..45  ...  2..1    0
  //     references,         bits of their    C(n, 1)      k of            k of    k of
  //     at most nine        number           is a leaf    D(n, 16)        D(n, 3) D(n, 2)
  //
  // A k of 0 stands for C(n, i) = C(n, i - 1). It is less than i, and has as many bits as that needs.
  static constexpr std::uint64_t leaf_bit = std::uint64_t{1} << 53;
  static constexpr std::uint32_t size_shift = 54, few_shift = 60;

  struct Costs;
  static std::uint64_t size_bits(std::uint32_t references);
  void solve(std::uint32_t node, std::uint32_t end, Costs& costs);
  void solve_leaf(std::uint32_t node, Costs& costs);
  void combine(std::uint32_t node, const Costs& left, const Costs& right, Costs& costs);
  void expand(std::uint32_t node, std::uint32_t i, Children& children) const;

  const BinaryTree* tree_;
  CollapseCosts costs_;
  Target target_;
  AlignedArray<std::uint64_t> decisions_;
};

}  // namespace kerf
