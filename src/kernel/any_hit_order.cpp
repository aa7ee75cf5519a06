#include "kernel/any_hit_order.hpp"

#include <algorithm>

#include "kernel/wide_children.hpp"

namespace kerf {

// How full a leaf's box is makes little difference to the order (0.3 takes as few steps as the triangles'
// areas do).
Prospect prospect_of_leaf(std::uint32_t triangles) {
  constexpr CollapseCosts costs;
  return {0.3f, costs.leaf + costs.triangle * static_cast<float>(triangles)};
}

Prospect arrange(const BinaryTree& tree, const Collapse::Children& children,
                 const std::array<Prospect, wide_node_children>& prospects, WideNode& node) {
  const std::uint32_t count = children.count;
  std::array<std::uint32_t, wide_node_children> from{};
  std::array<float, wide_node_children> value;
  for (std::uint32_t child = 0; child < count; ++child) {
    const float v = prospects[child].hit / prospects[child].steps;
    std::uint32_t slot = child;
    for (; slot > 0 && v < value[slot - 1]; --slot) {
      value[slot] = value[slot - 1];
      from[slot] = from[slot - 1];
    }
    value[slot] = v;
    from[slot] = child;
  }
  std::array<const BinaryNode*, wide_node_children> binaries{};
  std::array<ChildLink, wide_node_children> links;
  Box3f bounds;
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    binaries[slot] = &tree.nodes[children.node[from[slot]]];
    bounds = merge(bounds, binaries[slot]->bounds);
    links[slot] = node.children[from[slot]];
  }
  std::copy_n(links.begin(), count, node.children);
  write_children(binaries.data(), count, node);

  const float area = half_area(bounds);
  float miss = 1.0f, steps = 1.0f;
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    const Prospect& below = prospects[from[slot]];
    const float entered =
        std::min(1.0f, half_area(binaries[slot]->bounds) / area);  // 1 where that has no value
    miss *= 1.0f - entered * below.hit;
    steps += entered * below.steps;
  }
  return {1.0f - miss, steps};
}

}  // namespace kerf
