#include "layout/child_order.hpp"

#include <algorithm>
#include <limits>

#include "layout/wide_children.hpp"

namespace kerf {

// The probability of a hit in a leaf hardly changes the order: 0.3 takes as few steps as an estimate by the
// areas of triangles.
Prospect prospect_of_leaf(std::uint32_t triangles) {
  constexpr CollapseCosts costs;
  return {0.3f, costs.leaf + costs.triangle * static_cast<float>(triangles)};
}

template <std::uint32_t width>
Prospect arrange(Target target, std::span<const BinaryNode* const> children,
                 const std::array<Prospect, max_node_width>& prospects, WideNode<width>& node) {
  const auto count = static_cast<std::uint32_t>(children.size());
  // The slot of a child is the number of children before it. Compilers vectorise loops over all slots.
  std::array<float, width> value;
  std::array<std::uint32_t, width> slots{}, from;
  value.fill(std::numeric_limits<float>::infinity());
  for (std::uint32_t child = 0; child < count; ++child)
    value[child] = prospects[child].hit / prospects[child].steps;
  for (std::uint32_t child = 0; child < count; ++child) {
    for (std::uint32_t other = 0; other < width; ++other) {
      const bool is_less = value[child] < value[other], is_no_more = value[child] <= value[other];
      slots[other] += std::uint32_t{is_less} | (std::uint32_t{is_no_more} & std::uint32_t{child < other});
    }
  }
  for (std::uint32_t child = 0; child < count; ++child) from[slots[child]] = child;
  std::array<const BinaryNode*, width> binaries{};
  std::array<ChildLink, width> links;
  Box3f bounds;
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    binaries[slot] = children[from[slot]];
    bounds = merge(bounds, binaries[slot]->bounds);
    links[slot] = node.children[from[slot]];
  }
  std::copy_n(links.begin(), count, node.children);
  write_children(target, binaries.data(), count, node);

  const float area = half_area(bounds);
  float miss = 1.0f, steps = 1.0f;
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    const Prospect& below = prospects[from[slot]];
    const float entered = std::min(1.0f, half_area(binaries[slot]->bounds) / area);  // 1 for NaN
    miss *= 1.0f - entered * below.hit;
    steps += entered * below.steps;
  }
  return {1.0f - miss, steps};
}

template Prospect arrange(Target, std::span<const BinaryNode* const>,
                          const std::array<Prospect, max_node_width>&, WideNode<16>&);
template Prospect arrange(Target, std::span<const BinaryNode* const>,
                          const std::array<Prospect, max_node_width>&, WideNode<8>&);
template Prospect arrange(Target, std::span<const BinaryNode* const>,
                          const std::array<Prospect, max_node_width>&, WideNode<4>&);

}  // namespace kerf
