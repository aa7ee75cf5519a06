#include "refine/collapse.hpp"

#include <algorithm>
#include <limits>

namespace kerf {
namespace {

constexpr int max_leaf_references = 8;

}  // namespace

Collapse::Collapse(const BinaryTree& tree, const CollapseCosts& costs)
    : tree_(&tree), costs_(costs), least_(tree.nodes.size()), references_(tree.nodes.size()) {
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {  // children come after their parents
    const auto node = static_cast<std::uint32_t>(n);
    const BinaryNode& binary = tree.nodes[node];
    if (binary.is_leaf()) {
      references_[node] = static_cast<std::uint8_t>(binary.count);
      least_[node].fill(leaf_cost(node));
      continue;
    }
    references_[node] = static_cast<std::uint8_t>(
        std::min(references_[binary.left()] + references_[binary.right()], max_leaf_references + 1));
    std::uint32_t left_share;
    least_[node][0] = std::min(leaf_cost(node), half_area(binary.bounds) + distribute(node, 8, left_share));
    for (std::uint32_t i = 2; i <= most; ++i) {
      least_[node][i - 1] = std::min(distribute(node, i, left_share), cost(node, i - 1));
    }
  }
}

float Collapse::leaf_cost(std::uint32_t node) const {
  if (references_[node] > max_leaf_references) return std::numeric_limits<float>::infinity();
  return half_area(tree_->nodes[node].bounds) *
         (costs_.leaf + costs_.triangle * static_cast<float>(references_[node]));
}

// Written so that areas beyond the range of a float, all of whose sums are infinite, still give a valid tree.
bool Collapse::is_leaf(std::uint32_t node) const {
  if (tree_->nodes[node].is_leaf()) return true;
  return references_[node] <= max_leaf_references && cost(node, 1) >= leaf_cost(node);
}

float Collapse::distribute(std::uint32_t node, std::uint32_t i, std::uint32_t& left_share) const {
  const std::uint32_t left = tree_->nodes[node].left(), right = tree_->nodes[node].right();
  float least = std::numeric_limits<float>::infinity();
  left_share = 1;
  for (std::uint32_t k = 1; k < i; ++k) {
    const float sum = cost(left, k) + cost(right, i - k);
    if (sum < least) {
      least = sum;
      left_share = k;
    }
  }
  return least;
}

void Collapse::expand(std::uint32_t node, std::uint32_t i, Children& children) const {
  if (!tree_->nodes[node].is_leaf()) {
    while (i > 1 && i <= most && cost(node, i) == cost(node, i - 1)) --i;
    if (i > 1) {
      std::uint32_t left_share;
      distribute(node, i, left_share);
      expand(tree_->nodes[node].left(), left_share, children);
      expand(tree_->nodes[node].right(), i - left_share, children);
      return;
    }
  }
  children.node[children.count++] = node;
}

Collapse::Children Collapse::children(std::uint32_t node) const {
  Children children;
  expand(node, 8, children);
  return children;
}

}  // namespace kerf
