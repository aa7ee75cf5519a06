#include "tree/measures/epo.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "construction/construct.hpp"
#include "tree/measures/sample_trees.hpp"
#include "tree/polygon.hpp"

namespace kerf {
namespace {

TEST(Epo, OfTwoHalvesIsThatByHand) {
  const TwoHalves halves;
  const TriangleMesh mesh = halves.soup.mesh();
  // A quarter of the right triangle, whose area is 1/4, lies left of x = 0.5. The surface is 1/4 + 1/4.
  EXPECT_NEAR(end_point_overlap(halves.tree, Geometry({&mesh, 1})).value, (0.25 * 0.25) / 0.5, 1e-12);
}

TEST(Epo, ASplitTriangleDoesNotOverlapTheLeavesThatHoldIt) {
  TwoHalves halves;
  halves.tree.nodes[1].count = 2;
  halves.tree.nodes[2].first = 2;
  halves.tree.references = {0, 1, 1};
  const TriangleMesh mesh = halves.soup.mesh();
  EXPECT_EQ(end_point_overlap(halves.tree, Geometry({&mesh, 1})).value, 0.0);
}

TEST(Epo, EqualsTheSumOverAllPairs) {
  const Soup soup = random_soup(200, 0.2f, 1);
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  const BinaryTree tree = construct(geometry, {});
  // Every node with every triangle, its subtree gathered leaf by leaf.
  double overlap = 0.0, surface = 0.0;
  for (std::uint32_t id = 0; id < geometry.triangle_count(); ++id) {
    const Polygon polygon(geometry.triangle(id));
    surface += polygon.area();
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
      bool owned = false;
      std::vector<std::uint32_t> stack{n};
      while (!stack.empty()) {
        const BinaryNode& node = tree.nodes[stack.back()];
        stack.pop_back();
        for (std::uint32_t k = 0; k < node.count; ++k) owned |= tree.references[node.first + k] == id;
        if (!node.is_leaf()) stack.insert(stack.end(), {node.left(), node.right()});
      }
      const double cost = tree.nodes[n].is_leaf() ? tree.nodes[n].count : 1.2;
      if (!owned) overlap += cost * clip(polygon, tree.nodes[n].bounds).area();
    }
  }
  const Estimate estimate = end_point_overlap(tree, geometry);
  EXPECT_NEAR(estimate.value, overlap / surface, 1e-9 * overlap / surface);
  EXPECT_EQ(estimate.standard_error, 0.0) << "every triangle was looked at";
}

// Every triangle lies in every node: all pairs would be 2 n^2.
TEST(Epo, OfEqualTrianglesIsBoundedAndSaysHowWell) {
  constexpr std::uint32_t count = 5000;
  Soup soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<std::array<std::uint32_t, 3>>(count, {0, 1, 2})};
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  const BinaryTree tree = construct(geometry, {.builder = Builder::bvh});
  // A point overlaps all leaves but that of its triangle, and all inner nodes but those above it.
  double all = 0.0;
  for (const BinaryNode& node : tree.nodes) all += node.is_leaf() ? node.count : 1.2;
  const Estimate estimate = end_point_overlap(tree, geometry);
  EXPECT_GT(estimate.value, all - 100.0);
  EXPECT_LT(estimate.value, all);
  EXPECT_GT(estimate.standard_error, 0.0) << "a sample stands for all";
  EXPECT_LT(estimate.standard_error, 1e-3 * estimate.value);
}

TEST(Epo, OfASampleIsThatOfAllWithinItsError) {
  // Half of the triangles lie over one another; the others are small and on their own.
  constexpr std::uint32_t count = 1500;
  Soup soup = random_soup(count, 0.01f, 5);
  soup.vertices.insert(soup.vertices.end(), {{0, 0, 0.5f}, {1, 0, 0.5f}, {0, 1, 0.5f}});
  soup.triangles.insert(soup.triangles.end(), count, {3 * count, 3 * count + 1, 3 * count + 2});
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  const BinaryTree tree = construct(geometry, {.builder = Builder::bvh});
  const Estimate sampled = end_point_overlap(tree, geometry, 8.0);
  const Estimate exact = end_point_overlap(tree, geometry, std::numeric_limits<double>::infinity());
  ASSERT_GT(sampled.standard_error, 0.0);
  EXPECT_EQ(exact.standard_error, 0.0);
  EXPECT_NEAR(sampled.value, exact.value, 4.0 * sampled.standard_error);
}

TEST(Epo, IsTheSameForAnyNumberOfThreads) {
  const Soup soup = random_soup(3000, 0.1f, 3);
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  const BinaryTree tree = construct(geometry, {});
  const double overlap = end_point_overlap(tree, geometry).value;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(end_point_overlap(tree, geometry).value, overlap);
}

TEST(Epo, OfAnEmptyTreeIsZero) {
  const TriangleMesh mesh;
  EXPECT_EQ(end_point_overlap({}, Geometry({&mesh, 1})).value, 0.0);
}

}  // namespace
}  // namespace kerf
