#include "layout/wide_children.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/targets.hpp"

namespace {

using kerf::BinaryNode;
using kerf::WideNode;

// Coordinates from a small set, so that many centers are at the same distance.
std::vector<BinaryNode> random_children(std::mt19937& random, std::uint32_t count) {
  std::uniform_int_distribution<int> coordinate(-3, 3), size(0, 2);
  std::vector<BinaryNode> children(count);
  for (BinaryNode& child : children) {
    for (int axis = 0; axis < 3; ++axis) {
      child.bounds.lower[axis] = static_cast<float>(coordinate(random)) * 0.3f;
      child.bounds.upper[axis] = child.bounds.lower[axis] + static_cast<float>(size(random)) * 0.7f;
    }
    child.count = 1;
  }
  return children;
}

// The position of half the center along the diagonal of an octant, in floats as in the definition.
float distance_along(const kerf::Box3f& box, unsigned octant) {
  float sum = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const float center = box.lower[axis] * 0.25f + box.upper[axis] * 0.25f;
    sum += octant >> axis & 1 ? -center : center;
  }
  return sum;
}

template <class Node>
std::uint64_t order_by_sorting(const std::vector<BinaryNode>& children, unsigned octant) {
  std::vector<std::uint32_t> slots(Node::width);
  std::iota(slots.begin(), slots.end(), 0u);
  const auto key = [&](std::uint32_t slot) {
    return std::pair(distance_along(children[slot].bounds, octant), slot);
  };
  std::sort(slots.begin(), slots.begin() + static_cast<std::ptrdiff_t>(children.size()),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::uint64_t order = 0;
  for (std::uint32_t place = 0; place < slots.size(); ++place)
    order |= std::uint64_t{slots[place]} << (Node::slot_bits * place);
  return order;
}

template <class Node>
void expect_written(const kerf::Target& target, const std::vector<BinaryNode>& children) {
  std::vector<const BinaryNode*> pointers;
  for (const BinaryNode& child : children) pointers.push_back(&child);
  Node node;
  kerf::write_children(target, pointers.data(), static_cast<std::uint32_t>(children.size()), node);
  for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
    EXPECT_EQ(kerf::child_box(node, slot), slot < children.size() ? children[slot].bounds : kerf::Box3f{});
  }
  for (unsigned octant = 0; octant < 8; ++octant)
    EXPECT_EQ(node.order[octant], order_by_sorting<Node>(children, octant)) << "octant " << octant;
}

TEST(WideChildren, BoxesAndOrdersAreAsDefinedOnAnyInstructionSet) {
  kerf_tests::for_each_target([](const kerf::Target& target) {
    std::mt19937 random(7);
    for (std::uint32_t i = 0; i < 400; ++i) {
      expect_written<kerf::WideNode<16>>(target, random_children(random, 1 + i % 16));
      expect_written<kerf::WideNode<8>>(target, random_children(random, 1 + i % 8));
      expect_written<kerf::WideNode<4>>(target, random_children(random, 1 + i % 4));
    }
  });
}

}  // namespace
