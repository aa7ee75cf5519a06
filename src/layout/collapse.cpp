#include "layout/collapse.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "base/parallel.hpp"
#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "layout/collapse.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#ifndef KERF_LAYOUT_COLLAPSE_DISTRIBUTION
#define KERF_LAYOUT_COLLAPSE_DISTRIBUTION
namespace kerf {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace
}  // namespace kerf
#endif

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

#if KERF_FLOAT_LANES >= 8
namespace hn = hwy::HWY_NAMESPACE;

// Lane i - 1 of the k-th takes lane i - k - 1. Where there is none it takes the last, which is made infinite.
template <std::uint32_t slots>
struct Lanes {
  alignas(64) std::int32_t of[slots - 1][slots];
};
template <std::uint32_t slots>
constexpr Lanes<slots> lanes = [] {
  Lanes<slots> table{};
  for (std::int32_t k = 1; k < std::int32_t{slots}; ++k) {
    for (std::int32_t lane = 0; lane < std::int32_t{slots}; ++lane)
      table.of[k - 1][lane] = lane < k ? std::int32_t{slots} - 1 : lane - k;
  }
  return table;
}();

template <std::uint32_t slots>
HWY_INLINE void distribute_in_vector(const float* left, std::int32_t max_share, const float* right,
                                     Distribution& to) {
  constexpr hn::FixedTag<float, slots> floats;
  constexpr hn::FixedTag<std::int32_t, slots> ints;
  const auto none = hn::Set(floats, infinity);
  const auto costs = hn::IfThenElse(hn::FirstN(floats, slots - 1), hn::LoadU(floats, right), none);
  auto best = none;
  auto share = hn::Set(ints, 1);
  for (std::int32_t k = 1; k <= max_share; ++k) {
    const auto shifted = hn::TableLookupLanes(costs, hn::SetTableIndices(floats, lanes<slots>.of[k - 1]));
    const auto sum = hn::Add(hn::Set(floats, left[k - 1]), shifted);
    const auto better = hn::Lt(sum, best);
    best = hn::IfThenElse(better, sum, best);
    share = hn::IfThenElse(hn::RebindMask(ints, better), hn::Set(ints, k), share);
  }
  hn::Store(best, floats, to.cost);
  hn::Store(share, ints, to.left_share);
}
#endif

template <std::uint32_t slots>
HWY_INLINE void distribute_one_by_one(const float* left, std::int32_t max_share, const float* right,
                                      Distribution& to) {
  float shifted[2 * slots];  // what begins at slots - k begins with k infinite costs
  std::fill_n(shifted, slots, infinity);
  std::copy_n(right, slots, shifted + slots);
  std::fill_n(to.cost, slots, infinity);
  std::fill_n(to.left_share, slots, 1);
  for (std::int32_t k = 1; k <= max_share; ++k) {
    for (std::uint32_t i = 0; i < slots; ++i) {
      const float sum = left[k - 1] + shifted[slots - static_cast<std::uint32_t>(k) + i];
      const bool better = sum < to.cost[i];
      to.cost[i] = better ? sum : to.cost[i];
      to.left_share[i] = better ? k : to.left_share[i];
    }
  }
}

void distribute_16(const float* left, std::int32_t max_share, const float* right, Distribution& to) {
#if KERF_FLOAT_LANES == 16
  distribute_in_vector<16>(left, max_share, right, to);
#else
  distribute_one_by_one<16>(left, max_share, right, to);
#endif
}
void distribute_8(const float* left, std::int32_t max_share, const float* right, Distribution& to) {
#if KERF_FLOAT_LANES >= 8
  distribute_in_vector<8>(left, max_share, right, to);
#else
  distribute_one_by_one<8>(left, max_share, right, to);
#endif
}
void distribute_4(const float* left, std::int32_t max_share, const float* right, Distribution& to) {
  distribute_one_by_one<4>(left, max_share, right, to);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {
namespace {

HWY_EXPORT(distribute_16);
HWY_EXPORT(distribute_8);
HWY_EXPORT(distribute_4);

// Both halves of a subtree with more nodes than this are solved in parallel.
constexpr std::uint32_t max_serial_nodes = 4096;

// The same where one subtree is a leaf. A leaf costs the same in any number of slots: it takes one, the other
// subtree takes the rest.
void distribute_beside_leaf(float leaf, const float* other, bool leaf_is_left, std::uint32_t width,
                            Distribution& to) {
  to.cost[0] = infinity;
  for (std::uint32_t i = 2; i <= width; ++i) {
    to.cost[i - 1] = leaf + other[i - 2];
    to.left_share[i - 1] = leaf_is_left ? 1 : static_cast<std::int32_t>(i) - 1;
  }
}

// Position and mask of the k of D(n, i) in a node's word.
constexpr std::uint32_t share_shift(std::uint32_t i) {
  std::uint32_t shift = 0;
  for (std::uint32_t below = 2; below < i; ++below)
    shift += static_cast<std::uint32_t>(std::bit_width(below - 1));
  return shift;
}
struct Shares {
  std::uint32_t shift[max_node_width + 1], mask[max_node_width + 1];
};
constexpr Shares shares = [] {
  Shares table{};
  for (std::uint32_t i = 2; i <= max_node_width; ++i) {
    table.shift[i] = share_shift(i);
    table.mask[i] = (1u << std::bit_width(i - 1)) - 1;
  }
  return table;
}();
static_assert(share_shift(max_node_width + 1) == 49);

std::uint64_t share_bits(std::uint32_t i, std::int32_t share) {
  return static_cast<std::uint64_t>(share) << shares.shift[i];
}

}  // namespace

Distribute& distribute(std::uint32_t width, Target target) {
  return width == 16  ? KERF_DISPATCH(distribute_16, target)
         : width == 8 ? KERF_DISPATCH(distribute_8, target)
                      : KERF_DISPATCH(distribute_4, target);
}

// C(n, i) for i = 1 .. w - 1, and what else a parent needs to know.
struct Collapse::Costs {
  float of[max_node_width];  // the last is not used
  std::uint32_t references;
  std::uint32_t leaves;  // of the binary tree: no more slots can be used
};

Collapse::Collapse(const BinaryTree& tree, std::uint32_t width, const CollapseCosts& costs, Target target)
    : tree_(&tree),
      costs_(costs),
      distribute_(distribute(width, target)),
      width_(width),
      decisions_(tree.nodes.size()) {
  if (tree.empty()) return;
  Costs root;
  solve(0, static_cast<std::uint32_t>(tree.nodes.size()), root);
}

std::uint64_t Collapse::size_bits(std::uint32_t references) {
  return static_cast<std::uint64_t>(std::bit_width(references)) << size_shift |
         std::uint64_t{std::min(references, wide_leaf_triangles + 1)} << few_shift;
}

// Builders number the nodes below a left child first, then those below the right one, up to `end`. This is
// used to estimate how much work there is.
void Collapse::solve(std::uint32_t node, std::uint32_t end, Costs& costs) {
  const BinaryNode& binary = tree_->nodes[node];
  if (binary.is_leaf()) return solve_leaf(node, costs);
  const BinaryNode& right_node = tree_->nodes[binary.right()];
  const std::uint32_t middle = right_node.is_leaf() ? end : right_node.first;
  Costs left, right;
  if (end > binary.first + max_serial_nodes) {
    parallel_invoke([&] { solve(binary.left(), middle, left); }, [&] { solve(binary.right(), end, right); });
  } else {
    solve(binary.left(), middle, left);
    solve(binary.right(), end, right);
  }
  combine(node, left, right, costs);
}

void Collapse::solve_leaf(std::uint32_t node, Costs& costs) {
  const BinaryNode& binary = tree_->nodes[node];
  const float cost = visits(node) * (costs_.leaf + costs_.triangle * static_cast<float>(binary.count));
  std::fill_n(costs.of, width_, cost);
  costs.references = binary.count;
  costs.leaves = 1;
  decisions_[node] = leaf_bit | size_bits(binary.count);
}

// Areas beyond the range of a float, whose sums are all infinite, still give a valid tree.
void Collapse::combine(std::uint32_t node, const Costs& left, const Costs& right, Costs& costs) {
  Distribution best;
  if (left.leaves == 1) {
    distribute_beside_leaf(left.of[0], right.of, true, width_, best);
  } else if (right.leaves == 1) {
    distribute_beside_leaf(right.of[0], left.of, false, width_, best);
  } else {
    const auto max_share = static_cast<std::int32_t>(std::min(width_ - 1, left.leaves));
    distribute_(left.of, max_share, right.of, best);
  }
  const float area = visits(node);
  costs.references = left.references + right.references;
  costs.leaves = left.leaves + right.leaves;
  std::uint64_t decision = size_bits(costs.references);
  float min_cost = area + best.cost[width_ - 1];
  if (costs.references <= wide_leaf_triangles) {
    const float leaf = area * (costs_.leaf + costs_.triangle * static_cast<float>(costs.references));
    if (leaf <= min_cost) {
      min_cost = leaf;
      decision |= leaf_bit;
    }
  }
  costs.of[0] = min_cost;
  const std::uint32_t max_slots = std::min(width_ - 1, costs.leaves);
  for (std::uint32_t i = 2; i <= max_slots; ++i) {
    const bool divides = best.cost[i - 1] < min_cost;
    min_cost = divides ? best.cost[i - 1] : min_cost;
    costs.of[i - 1] = min_cost;
    decision |= share_bits(i, divides ? best.left_share[i - 1] : 0);
  }
  std::fill(costs.of + max_slots, costs.of + width_, min_cost);
  decision |= share_bits(width_, best.left_share[width_ - 1]);
  decisions_[node] = decision;
}

void Collapse::expand(std::uint32_t node, std::uint32_t i, Children& children) const {
  while (i > 1) {  // with one slot there is nothing to decide
    const auto left_share = static_cast<std::uint32_t>(decisions_[node] >> shares.shift[i]) & shares.mask[i];
    if (left_share == 0) {
      --i;
      continue;
    }
    const std::uint32_t left = tree_->nodes[node].left();
    expand(left, left_share, children);
    node = left + 1;
    i -= left_share;
  }
  children.node[children.count++] = node;
}

Collapse::Children Collapse::children(std::uint32_t node) const {
  Children children;
  expand(node, width_, children);
  return children;
}

}  // namespace kerf
#endif
