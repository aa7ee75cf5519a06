#include "layout/top_level.hpp"

#include <array>

#include "base/aligned_array.hpp"
#include "layout/child_order.hpp"
#include "layout/collapse.hpp"

namespace kerf {
namespace {

// To come to an instance costs the ray's way into its object's space, and the nodes there.
constexpr CollapseCosts instance_costs{.leaf = 0.1f, .triangle = 10.0f};

template <class Node>
class TopLevelWriter {
 public:
  TopLevelWriter(const BinaryTree& tree, Target target, TopLevel& top)
      : tree_(tree), collapse_(tree, Node::width, instance_costs, target), target_(target), top_(top) {}

  void write() {
    const AlignedArray<Node> nodes(count(0));
    nodes_ = nodes.data();
    std::uint32_t next = 0;
    top_.numbers.reserve(tree_.references.size());
    write(0, 1, next);
    const Box3f& bounds = tree_.nodes[0].bounds;
    top_.nodes = {.width = Node::width,
                  .node_count = next,
                  .node_data = nodes_,
                  .leaves = {},
                  .bounds = bounds,
                  .largest_coordinate = largest_coordinate(bounds),
                  .depth = depth_,
                  .node_memory = nodes.owner(),
                  .leaf_memory = nullptr};
  }

 private:
  std::uint32_t count(std::uint32_t binary) const {
    std::uint32_t nodes = 1;
    const Collapse::Children children = collapse_.children(binary);
    for (std::uint32_t i = 0; i < children.count; ++i)
      if (!collapse_.is_leaf(children.node[i])) nodes += count(children.node[i]);
    return nodes;
  }

  void gather(std::uint32_t binary) {
    const BinaryNode& node = tree_.nodes[binary];
    if (!node.is_leaf()) {
      gather(node.left());
      gather(node.right());
      return;
    }
    for (std::uint32_t i = 0; i < node.count; ++i) top_.numbers.push_back(tree_.references[node.first + i]);
  }

  Prospect write(std::uint32_t binary, std::uint32_t depth, std::uint32_t& next) {
    Node& node = nodes_[next++];
    depth_ = std::max(depth_, depth);
    std::array<Prospect, max_node_width> below;
    const Collapse::Children children = collapse_.children(binary);
    for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
      if (slot >= children.count) {
        node.children[slot] = ChildLink::leaf(0, 1);
      } else if (collapse_.is_leaf(children.node[slot])) {
        const auto first = static_cast<std::uint32_t>(top_.numbers.size());
        gather(children.node[slot]);
        const auto here = static_cast<std::uint32_t>(top_.numbers.size()) - first;
        node.children[slot] = ChildLink::leaf(first, here);
        below[slot] = prospect_of_leaf(here);
      }
    }
    for (std::uint32_t slot = 0; slot < children.count; ++slot) {
      if (collapse_.is_leaf(children.node[slot])) continue;
      node.children[slot] = ChildLink::node(next);
      below[slot] = write(children.node[slot], depth + 1, next);
    }
    return arrange(target_, tree_, children, below, node);
  }

  const BinaryTree& tree_;
  const Collapse collapse_;
  const Target target_;
  TopLevel& top_;
  Node* nodes_ = nullptr;
  std::uint32_t depth_ = 0;
};

}  // namespace

TopLevel make_top_level(const BinaryTree& tree, std::uint32_t width, Target target) {
  TopLevel top;
  if (tree.empty()) return top;
  with_width(width, [&](auto w) { TopLevelWriter<WideNode<w>>(tree, target, top).write(); });
  return top;
}

}  // namespace kerf
