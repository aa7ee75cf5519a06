// From a binary tree to a wide one: which binary nodes become the children of a wide node, and which a leaf.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tree/binary_tree.hpp"

namespace kerf {

/// What traversal pays on the machine at hand, in visits of a wide node.
struct CollapseCosts {
  float leaf = 0.4f;       ///< to come to a leaf
  float triangle = 0.03f;  ///< more for each of its triangles, which are tested together
};

/// The cost-optimal way to cut a binary tree into nodes of up to eight children (Ylitie, Karras & Laine 2017,
/// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3).
///
/// With C(n, i) the least cost of the subtree n when it stands for up to i children of some wide node,
///
///     C(n, 1) = min(leaf, A(n) + D(n, 8))           one child: a leaf or a wide node
///     C(n, i) = min(D(n, i), C(n, i - 1))           2 <= i <= 7
///     D(n, i) = min over k of C(left, k) + C(right, i - k)
class Collapse {
 public:
  explicit Collapse(const BinaryTree& tree, const CollapseCosts& costs = {});

  /// The binary nodes that are the children of the wide node of `node`, in the tree's order.
  struct Children {
    std::array<std::uint32_t, 8> node;
    std::uint32_t count = 0;
  };
  Children children(std::uint32_t node) const;

  /// Whether the binary node, a child of a wide one, becomes a leaf.
  bool is_leaf(std::uint32_t node) const;

 private:
  static constexpr std::uint32_t most = 7;

  float cost(std::uint32_t node, std::uint32_t i) const { return least_[node][i - 1]; }
  float leaf_cost(std::uint32_t node) const;
  float distribute(std::uint32_t node, std::uint32_t i, std::uint32_t& left_share) const;
  void expand(std::uint32_t node, std::uint32_t i, Children& children) const;

  const BinaryTree* tree_;
  CollapseCosts costs_;
  std::vector<std::array<float, most>> least_;  // least_[n][i - 1] is C(n, i)
  std::vector<std::uint8_t> references_;        // below each node; more than eight count as nine
};

}  // namespace kerf
