#include "tree/measures/epo.hpp"

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
  EXPECT_NEAR(end_point_overlap(halves.tree, Geometry({&mesh, 1})), (0.25 * 0.25) / 0.5, 1e-12);
}

TEST(Epo, ASplitTriangleDoesNotOverlapTheLeavesThatHoldIt) {
  TwoHalves halves;
  halves.tree.nodes[1].count = 2;
  halves.tree.nodes[2].first = 2;
  halves.tree.references = {0, 1, 1};
  const TriangleMesh mesh = halves.soup.mesh();
  EXPECT_EQ(end_point_overlap(halves.tree, Geometry({&mesh, 1})), 0.0);
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
  EXPECT_NEAR(end_point_overlap(tree, geometry), overlap / surface, 1e-9 * overlap / surface);
}

TEST(Epo, IsTheSameForAnyNumberOfThreads) {
  const Soup soup = random_soup(3000, 0.1f, 3);
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  const BinaryTree tree = construct(geometry, {});
  const double overlap = end_point_overlap(tree, geometry);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(end_point_overlap(tree, geometry), overlap);
}

TEST(Epo, OfAnEmptyTreeIsZero) {
  const TriangleMesh mesh;
  EXPECT_EQ(end_point_overlap({}, Geometry({&mesh, 1})), 0.0);
}

}  // namespace
}  // namespace kerf
