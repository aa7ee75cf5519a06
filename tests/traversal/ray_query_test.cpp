// What single rays do in trees that no builder makes.
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/counters.hpp>

#include "layout/wide_bvh.hpp"
#include "traversal/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {
namespace {

constexpr Box3f everywhere{{-1.0f, -1.0f, -1.0f}, {1.0f, 1.0f, 1.0f}};

// All rays through the origin meet all of `children`, from the last to the first.
WideNode node_of(std::span<const ChildLink> children) {
  WideNode node{};
  for (std::uint32_t slot = 0; slot < wide_node_children; ++slot) {
    const bool used = slot < children.size();
    for (int axis = 0; axis < 3; ++axis) {
      const float infinity = std::numeric_limits<float>::infinity();
      node.planes[axis][0][slot] = used ? everywhere.lower[axis] : infinity;
      node.planes[axis][1][slot] = used ? everywhere.upper[axis] : -infinity;
    }
    node.children[slot] = used ? children[slot] : ChildLink::leaf(0, 1);
    for (std::uint64_t& order : node.order)
      order |= std::uint64_t{wide_node_children - 1 - slot} << (4 * slot);
  }
  return node;
}

// Three full nodes at each depth; the children of the first are the next three and barren ones, those of the
// others all barren. A ray that takes three nodes at a time has all but three of their children open at every
// depth.
TEST(WideTraversal, TheDeepestTreeWithTheMostOpenNodesFitsTheStack) {
  constexpr std::uint32_t fertile = 3;
  const ChildLink barren = ChildLink::node(1);
  const std::vector<ChildLink> all_barren(wide_node_children, barren);
  std::vector<WideNode> nodes(2, node_of({}));  // the root, to be written yet, and the barren one
  std::size_t visits = 1;
  std::size_t first = 0;
  for (std::uint32_t depth = 1; depth < max_tree_depth; ++depth) {
    const auto next = static_cast<std::uint32_t>(nodes.size());
    std::vector<ChildLink> children(wide_node_children, barren);
    for (std::uint32_t i = 0; i < fertile; ++i)
      children[wide_node_children - 1 - i] = ChildLink::node(next + i);
    nodes[first] = node_of(children);
    visits += wide_node_children;
    first = next;
    nodes.push_back(node_of({}));  // has its children in the next round
    const bool last = depth + 1 == max_tree_depth;
    for (std::uint32_t i = 1; i < fertile; ++i) {
      nodes.push_back(last ? node_of({}) : node_of(all_barren));
      if (!last) visits += wide_node_children;
    }
  }
  const std::vector<std::uint32_t> leaves(words_per_triangle + leaf_padding_words);
  const WideBvh bvh{.nodes = nodes,
                    .leaves = leaves,
                    .bounds = everywhere,
                    .largest_coordinate = 1.0f,
                    .depth = max_tree_depth,
                    .node_memory = nullptr,
                    .leaf_memory = nullptr};
  const Ray ray{.origin = {-2.0f, 0.1f, 0.2f}, .direction = {1.0f, 0.0f, 0.0f}};
  TraversalCounters closest, any;
  EXPECT_FALSE(choose_kernels().closest_counted(bvh, ray, closest));
  EXPECT_FALSE(choose_kernels().any_counted(bvh, ray, any));
  EXPECT_EQ(closest.steps, visits);
  EXPECT_EQ(any.steps, visits);
}

}  // namespace
}  // namespace kerf
