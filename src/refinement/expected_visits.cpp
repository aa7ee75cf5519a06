#include "refinement/expected_visits.hpp"

#include <array>
#include <atomic>
#include <cstdint>

#include "base/parallel.hpp"
#include "refinement/way.hpp"

namespace kerf {
namespace {

constexpr std::size_t rays_per_task = 64;

std::vector<std::atomic<std::uint32_t>> count_visits(const BinaryTree& tree, std::span<const Ray> ways) {
  std::vector<std::atomic<std::uint32_t>> counts(tree.nodes.size());
  parallel_for_ranges(std::size_t{0}, ways.size(), rays_per_task, [&](const IndexRange<std::size_t>& range) {
    std::array<std::uint32_t, max_tree_depth + 1> stack;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Way way(ways[i]);
      std::size_t size = 0;
      stack[size++] = 0;
      while (size != 0) {
        const std::uint32_t n = stack[--size];
        const BinaryNode& node = tree.nodes[n];
        if (!way.meets(node.bounds)) continue;
        counts[n].fetch_add(1, std::memory_order_relaxed);
        if (node.is_leaf()) continue;
        stack[size++] = node.right();
        stack[size++] = node.left();
      }
    }
  });
  return counts;
}

}  // namespace

void expect_visits(BinaryTree& tree, std::span<const Ray> ways) {
  constexpr float everywhere = 8.0f;
  const auto counts = count_visits(tree, ways);
  tree.visits.resize(tree.nodes.size());
  tree.visits[0] = static_cast<float>(counts[0].load()) + everywhere;
  const auto set = [&](std::uint32_t n, std::uint32_t child) {
    const float area = half_area(tree.nodes[n].bounds);
    const float share = area > 0.0f ? half_area(tree.nodes[child].bounds) / area : 1.0f;
    tree.visits[child] = tree.visits[n] * (static_cast<float>(counts[child].load()) + everywhere * share) /
                         (static_cast<float>(counts[n].load()) + everywhere);
  };
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {  // children come after their parents
    const BinaryNode& node = tree.nodes[n];
    if (node.is_leaf()) continue;
    set(n, node.left());
    set(n, node.right());
  }
}

}  // namespace kerf
