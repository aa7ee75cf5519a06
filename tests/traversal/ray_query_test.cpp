// Counted rays, coherent rays, and single rays in a tree that no builder makes.
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/counters.hpp>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "layout/wide_bvh.hpp"
#include "support/random_scenes.hpp"
#include "support/targets.hpp"
#include "traversal/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {
namespace {

constexpr Box3f everywhere{{-1.0f, -1.0f, -1.0f}, {1.0f, 1.0f, 1.0f}};

// All rays through the origin meet all of `children`, from the last to the first.
template <class Node>
Node node_of(std::span<const ChildLink> children) {
  Node node{};
  for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
    const bool used = slot < children.size();
    for (int axis = 0; axis < 3; ++axis) {
      const float infinity = std::numeric_limits<float>::infinity();
      node.planes[axis][0][slot] = used ? everywhere.lower[axis] : infinity;
      node.planes[axis][1][slot] = used ? everywhere.upper[axis] : -infinity;
    }
    node.children[slot] = used ? children[slot] : ChildLink::leaf(0, 1);
    for (auto& order : node.order) {
      order |= static_cast<typename Node::Order>(std::uint64_t{Node::width - 1 - slot}
                                                 << (Node::slot_bits * slot));
    }
  }
  return node;
}

// Three full nodes at each depth. The children of the first are the next three and otherwise barren nodes,
// the children of the other two are all barren. A ray that takes three nodes per step has all but three of
// their children open at every depth.
template <class Node>
void expect_the_deepest_tree_to_fit() {
  const std::span<const ChildLink> nothing;
  constexpr std::uint32_t fertile = 3;
  const ChildLink barren = ChildLink::node(1);
  const std::vector<ChildLink> all_barren(Node::width, barren);
  std::vector<Node> nodes(2, node_of<Node>(nothing));  // the root, which is written later, and the barren one
  std::size_t visits = 1;
  std::size_t first = 0;
  for (std::uint32_t depth = 1; depth < max_tree_depth; ++depth) {
    const auto next = static_cast<std::uint32_t>(nodes.size());
    std::vector<ChildLink> children(Node::width, barren);
    for (std::uint32_t i = 0; i < fertile; ++i) children[Node::width - 1 - i] = ChildLink::node(next + i);
    nodes[first] = node_of<Node>(children);
    visits += Node::width;
    first = next;
    nodes.push_back(node_of<Node>(nothing));  // gets its children in the next iteration
    const bool last = depth + 1 == max_tree_depth;
    for (std::uint32_t i = 1; i < fertile; ++i) {
      nodes.push_back(last ? node_of<Node>(nothing) : node_of<Node>(all_barren));
      if (!last) visits += Node::width;
    }
  }
  const std::vector<std::uint32_t> leaves(words_per_triangle + leaf_padding_words);
  const WideBvh bvh{.width = Node::width,
                    .node_count = static_cast<std::uint32_t>(nodes.size()),
                    .node_data = nodes.data(),
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

TEST(RayQuery, TheDeepestTreeWithTheMostOpenNodesFitsTheStack) {
  kerf_tests::for_each_target([](const Target&) {
    with_width(choose_kernels().node_width,
               [](auto width) { expect_the_deepest_tree_to_fit<WideNode<width>>(); });
  });
}

TEST(RayQuery, CountingChangesNoHit) {
  std::mt19937 random(11);
  const TriangleSoup soup = random_soup(random, 500, 0.3f, 0.2f);
  const kerf::Bvh bvh = kerf::build(soup.mesh());
  kerf::TraversalCounters counters;
  for (int i = 0; i < 1000; ++i) {
    const kerf::Ray ray{.origin = random_point(random), .direction = random_point(random)};
    ASSERT_EQ(kerf::intersect(bvh, ray, counters), bvh.intersect(ray));
    ASSERT_EQ(kerf::occluded(bvh, ray, counters), bvh.occluded(ray));
  }
  EXPECT_GT(counters.steps, 2000u);
  EXPECT_GE(counters.triangle_tests, counters.leaves);
}

TEST(RayQuery, CoherentRaysAreHitAsSingleOnes) {
  std::mt19937 random(12);
  struct Scene {
    std::uint32_t triangles;
    float size;
  };
  // The last is too large for single rays, and is traced by interleaved ones.
  for (const auto& [triangles, size] : {Scene{3000, 0.05f}, Scene{3000, 0.6f}, Scene{120000, 0.02f}}) {
    TriangleSoup soup = random_soup(random, triangles, size, 0.5f);
    const std::vector<std::uint32_t> once(soup.triangles.begin(), soup.triangles.begin() + 300);
    soup.triangles.insert(soup.triangles.end(), once.begin(), once.end());  // ties
    std::vector<kerf::Ray> rays;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const kerf::Vec3f direction{static_cast<float>(x - 20) / 200.0f, static_cast<float>(y - 40) / 200.0f,
                                    1.0f};
        rays.push_back({.origin = {0.1f, 0.0f, -2.0f}, .direction = direction});
        if (y > 32) rays.back().t_max = 2.0f + 0.01f * static_cast<float>(x);
        if (y > 48) rays.back().origin.x += 0.0001f * static_cast<float>(x);
        if (y > 56) rays.back().t_min = 1.5f;
        if (y < 16) rays.back().origin.z = 0.0f;
        if (y < 16) rays.back().t_min = y < 8 ? -0.7f : -std::numeric_limits<float>::infinity();
      }
    }
    rays[100].direction = {};
    rays[200].t_max = -1.0f;
    kerf_tests::for_each_target([&](const kerf::Target&) {
      const kerf::Bvh bvh = kerf::build(soup.mesh());
      std::vector<kerf::Hit> hits(rays.size());
      std::vector<std::uint8_t> occluded(rays.size());
      bvh.intersect(rays, hits);
      bvh.occluded(rays, occluded);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i], bvh.intersect(rays[i]).value_or(kerf::Hit{})) << i;
        ASSERT_EQ(occluded[i] != 0, bvh.occluded(rays[i])) << i;
      }
    });
  }
}

}  // namespace
}  // namespace kerf
