// Nodes over boxes: that they hold all of them, and what they cost beside a tree that is split to the last.
#include "scene/top_level.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/build.hpp>

#include "base/parallel.hpp"
#include "construction/sbvh/parallel_build.hpp"
#include "layout/collapse.hpp"
#include "support/adversarial.hpp"
#include "support/instrumented.hpp"

namespace {

using adversarial::uniform;
using adversarial::uniform_point;
using kerf::Box3f;
using kerf::Reference;
using kerf::WideBvh;
using kerf::WideNode;

std::vector<Reference> boxes(std::size_t count, float size, std::mt19937& random) {
  std::vector<Reference> references;
  for (std::uint32_t i = 0; i < count; ++i) {
    const kerf::Vec3f at = uniform_point(random, 1.0f);
    references.emplace_back(Box3f{at, at + kerf::Vec3f{uniform(random, 0, size), uniform(random, 0, size),
                                                       uniform(random, 0, size)}},
                            7 * i);
  }
  return references;
}

struct Built {
  WideBvh nodes;
  std::vector<std::uint32_t> primitives;
};

Built build(std::vector<Reference> references, std::uint32_t width) {
  Built built{{}, std::vector<std::uint32_t>(references.size())};
  built.nodes = kerf::build_top_level(references, built.primitives.data(), width, kerf::choose_target());
  return built;
}

bool holds(const Box3f& outer, const Box3f& inner) {
  const Box3f both = merge(outer, inner);
  return both.lower == outer.lower && both.upper == outer.upper;
}

// The boxes of the leaves below a node, all of which lie in `bounds`.
template <std::uint32_t width>
void visit(const WideBvh& bvh, std::uint32_t number, const Box3f& bounds, std::uint32_t depth,
           std::vector<Box3f>& leaves) {
  ASSERT_LE(depth, bvh.depth);
  const auto& node = bvh.nodes<WideNode<width>>()[number];
  for (std::uint32_t slot = 0; slot < width; ++slot) {
    const Box3f box = child_box(node, slot);
    const kerf::ChildLink child = node.children[slot];
    if (box.empty()) {
      ASSERT_TRUE(child.is_leaf());
      ASSERT_LT(child.first(), leaves.size());
      continue;
    }
    ASSERT_TRUE(holds(bounds, box));
    if (child.is_leaf()) {
      ASSERT_EQ(child.count(), 1u);
      ASSERT_TRUE(leaves[child.first()].empty()) << "a leaf stands in two places";
      leaves[child.first()] = box;
    } else {
      visit<width>(bvh, child.node(), box, depth + 1, leaves);
    }
  }
}

void expect_all_held(const std::vector<Reference>& references) {
  for (const std::uint32_t width : {16u, 8u, 4u}) {
    SCOPED_TRACE(testing::Message() << references.size() << " boxes, " << width << " children");
    const Built built = build(references, width);
    std::vector<Box3f> leaves(references.size());
    kerf::with_width(width, [&](auto w) { visit<w>(built.nodes, 0, built.nodes.bounds, 1, leaves); });
    if (testing::Test::HasFatalFailure()) return;
    std::vector<std::uint32_t> sorted = built.primitives;
    std::sort(sorted.begin(), sorted.end());
    for (std::uint32_t i = 0; i < references.size(); ++i) {
      ASSERT_EQ(sorted[i], references[i].primitive);
      const Reference& reference = references[built.primitives[i] / 7];
      ASSERT_EQ(leaves[i].lower, reference.lower);
      ASSERT_EQ(leaves[i].upper, reference.upper);
    }
  }
}

TEST(TopLevel, EveryBoxIsThatOfOneLeafWithinTheBoxesAboveIt) {
  std::mt19937 random(1);
  for (std::size_t count = 1; count <= 70; ++count) expect_all_held(boxes(count, 0.5f, random));
  for (const std::size_t count : {300u, 1025u, 9000u}) expect_all_held(boxes(count, 0.1f, random));
}

TEST(TopLevel, BoxesThatCannotBeToldApartAreHeldAsWell) {
  std::vector<Reference> same, vast;
  for (std::uint32_t i = 0; i < 2500; ++i) {
    same.emplace_back(Box3f{{1, 2, 3}, {1, 2, 3}}, 7 * i);
    const float far = std::ldexp(i % 2 == 0 ? 1.0f : -1.0f, 125);
    vast.emplace_back(Box3f{{-std::abs(far), far, 0}, {std::abs(far), far, i % 3 == 0 ? far : 0}}, 7 * i);
    for (int axis = 0; axis < 3; ++axis)
      if (vast.back().lower[axis] > vast.back().upper[axis])
        std::swap(vast.back().lower[axis], vast.back().upper[axis]);
  }
  expect_all_held(same);
  expect_all_held(vast);
}

TEST(TopLevel, NodesAreTheSameOnAnyNumberOfThreads) {
  std::mt19937 random(2);
  const std::vector<Reference> references = boxes(30'000, 0.05f, random);
  const Built alone = kerf::on_this_thread([&] { return build(references, 16); });
  for (const unsigned threads : {2u, 5u}) {
    const Built together = kerf::on_threads(threads, [&] { return build(references, 16); });
    EXPECT_EQ(together.primitives, alone.primitives);
    ASSERT_EQ(together.nodes.node_count, alone.nodes.node_count);
    EXPECT_EQ(std::memcmp(together.nodes.node_data, alone.nodes.node_data, alone.nodes.node_bytes()), 0);
  }
}

// The area of all wide nodes: what a ray that comes from anywhere pays.
double node_area(const WideBvh& bvh, std::uint32_t width) {
  double sum = half_area(bvh.bounds);
  kerf::with_width(width, [&](auto w) {
    for (std::uint32_t i = 0; i < bvh.node_count; ++i) {
      const auto& node = bvh.nodes<WideNode<w>>()[i];
      for (std::uint32_t slot = 0; slot < width; ++slot)
        if (!node.children[slot].is_leaf()) sum += half_area(child_box(node, slot));
    }
  });
  return sum;
}

double node_area(const kerf::BinaryTree& tree, const kerf::Collapse& collapse, std::uint32_t binary) {
  double sum = half_area(tree.nodes[binary].bounds);
  const kerf::Collapse::Children children = collapse.children(binary);
  for (std::uint32_t i = 0; i < children.count; ++i)
    if (!collapse.is_leaf(children.node[i])) sum += node_area(tree, collapse, children.node[i]);
  return sum;
}

TEST(TopLevel, CostsAtMostATenthMoreThanTheBestCollapseOfATreeSplitToTheLastBox) {
  std::mt19937 random(3);
  for (const float size : {0.3f, 0.03f, 0.003f}) {
    const std::vector<Reference> references = boxes(4000, size, random);
    kerf::BuildOptions options;
    options.max_leaf_size = 1;
    const kerf::BinaryTree tree = kerf::construct_object_split_tree(references, options);
    for (const std::uint32_t width : {16u, 8u, 4u}) {
      const kerf::Collapse best(tree, width, {.leaf = 0.1f, .triangle = 10.0f});
      EXPECT_LT(node_area(build(references, width).nodes, width), 1.1 * node_area(tree, best, 0))
          << width << " children, boxes of " << size;
    }
  }
}

}  // namespace
