#include "refinement/movable_tree.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"

namespace kerf {

MovableTree::MovableTree(BinaryTree& tree, const RayFlux* flux)
    : tree_(tree),
      flux_(flux),
      parents_(tree.nodes.size() / 2),
      references_(tree.nodes.size()),
      heights_(tree.nodes.size()),
      measures_(flux != nullptr ? tree.nodes.size() : 0) {
  static_assert(max_tree_depth < 256);
  for (std::uint32_t n = node_count(); n-- > 0;) {  // children come after their parents
    if (!node(n).is_leaf()) parents_[pair_of(node(n).left())] = n;
    summarize(n);
  }
  parallel_for_ranges(std::size_t{0}, measures_.size(), std::size_t{1024},
                      [&](const IndexRange<std::size_t>& range) {
                        for (std::size_t n = range.begin(); n < range.end(); ++n)
                          measures_[n] = measure(tree_.nodes[n].bounds);
                      });
}

bool MovableTree::is_below(std::uint32_t n, std::uint32_t ancestor) const {
  while (n != ancestor && n != 0) n = parent(n);
  return n == ancestor;
}

std::uint32_t MovableTree::depth(std::uint32_t n) const {
  std::uint32_t depth = 0;
  for (; n != 0; n = parent(n)) ++depth;
  return depth;
}

bool MovableTree::can_move(std::uint32_t n, std::uint32_t target) const {
  if (n == 0 || target == 0 || parent(n) == 0) return false;
  if (target == parent(n) || target == sibling(n) || is_below(target, n)) return false;
  return depth(target) + 1u + std::max(heights_[n], heights_[target]) <= max_tree_depth;
}

std::uint32_t MovableTree::move(std::uint32_t n, std::uint32_t target) {
  const std::uint32_t place = parent(n), left = std::min(n, sibling(n));
  const BinaryNode moved = node(n);
  const float measure_of_moved = measure_of(n);
  put(place, node(sibling(n)), measure_of(sibling(n)));
  fit_upwards(parent(place));
  // The pair of siblings is free now.
  put(left, node(target), measure_of(target));
  put(left + 1, moved, measure_of_moved);
  BinaryNode& inner = tree_.nodes[target];
  inner.first = left;
  inner.count = 0;
  parents_[pair_of(left)] = target;
  fit_upwards(target);
  return place;
}

void MovableTree::put(std::uint32_t place, const BinaryNode& content, float measure) {
  tree_.nodes[place] = content;
  if (flux_ != nullptr) measures_[place] = measure;
  if (!content.is_leaf()) parents_[pair_of(content.left())] = place;
  summarize(place);
}

void MovableTree::summarize(std::uint32_t n) {
  const BinaryNode& of = node(n);
  references_[n] = of.is_leaf() ? of.count : references_[of.left()] + references_[of.right()];
  heights_[n] = of.is_leaf()
                    ? std::uint8_t{0}
                    : static_cast<std::uint8_t>(1 + std::max(heights_[of.left()], heights_[of.right()]));
}

void MovableTree::fit_upwards(std::uint32_t n) {
  for (;; n = parent(n)) {
    BinaryNode& inner = tree_.nodes[n];
    const Box3f bounds = merge(box(inner.left()), box(inner.right()));
    if (flux_ != nullptr && bounds != inner.bounds) measures_[n] = measure(bounds);
    inner.bounds = bounds;
    summarize(n);
    if (n == 0) return;
  }
}

void number_depth_first(BinaryTree& tree) {
  struct Step {
    std::uint32_t from, to;
  };
  UninitializedVector<BinaryNode> nodes(tree.nodes.size());
  UninitializedVector<std::uint32_t> references(tree.references.size());
  std::uint32_t next_node = 1, next_reference = 0;
  std::vector<Step> stack{{0, 0}};
  while (!stack.empty()) {
    const Step step = stack.back();
    stack.pop_back();
    BinaryNode node = tree.nodes[step.from];
    if (node.is_leaf()) {
      std::copy_n(tree.references.begin() + node.first, node.count, references.begin() + next_reference);
      node.first = std::exchange(next_reference, next_reference + node.count);
    } else {
      stack.push_back({node.right(), next_node + 1});
      stack.push_back({node.left(), next_node});
      node.first = std::exchange(next_node, next_node + 2);
    }
    nodes[step.to] = node;
  }
  tree.nodes = std::move(nodes);
  tree.references = std::move(references);
}

}  // namespace kerf
