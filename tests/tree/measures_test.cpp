#include "tree/measures/measures.hpp"

#include <array>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "construction/construct.hpp"
#include "tree/polygon.hpp"

namespace kerf {
namespace {

struct Soup {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

Soup random_soup(std::uint32_t count, float size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0.0f, 1.0f), offset(-size, size);
  Soup soup;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::array<float, 3> centre{place(random), place(random), place(random)};
    for (int k = 0; k < 3; ++k) {
      soup.vertices.push_back(
          {centre[0] + offset(random), centre[1] + offset(random), centre[2] + offset(random)});
    }
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return soup;
}

// Two leaves that each hold half of the unit cube, with one triangle each.
//
//   the left one in the plane z = 0.5, entirely in its half; the right one, of area 1/4, with 3/4 of it in
//   the right half and the rest in the left leaf's box
struct TwoHalves {
  Soup soup{{{0, 0, 0.5f}, {0.5f, 0, 0.5f}, {0, 1, 0.5f}, {1, 0, 0.5f}, {1, 0.5f, 0.5f}, {0, 0.5f, 0.5f}},
            {{0, 1, 2}, {3, 4, 5}}};
  BinaryTree tree{.nodes = {{{{0, 0, 0}, {1, 1, 1}}, 1, 0},
                            {{{0, 0, 0}, {0.5f, 1, 1}}, 0, 1},
                            {{{0.5f, 0, 0}, {1, 1, 1}}, 1, 1}},
                  .references = {0, 1}};
};

TEST(Metrics, SurfaceAreaCostOfTwoHalvesIsThatByHand) {
  EXPECT_DOUBLE_EQ(surface_area_cost(TwoHalves().tree), 1.2 + 2.0 * 4.0 / 6.0);
}

TEST(Metrics, OverlapOfTwoHalvesIsThatByHand) {
  const TwoHalves halves;
  const TriangleMesh mesh = halves.soup.mesh();
  // Of the right triangle, the corner left of x = 0.5 is one quarter of an area of 1/4; the surface is 1/4 +
  // 1/4.
  EXPECT_NEAR(end_point_overlap(halves.tree, Geometry({&mesh, 1})), (0.25 * 0.25) / 0.5, 1e-12);
}

TEST(Metrics, ASplitTriangleDoesNotOverlapTheLeavesThatHoldIt) {
  TwoHalves halves;
  halves.tree.nodes[1].count = 2;
  halves.tree.nodes[2].first = 2;
  halves.tree.references = {0, 1, 1};
  const TriangleMesh mesh = halves.soup.mesh();
  EXPECT_EQ(end_point_overlap(halves.tree, Geometry({&mesh, 1})), 0.0);
}

TEST(Metrics, VariabilityOfTwoHalvesIsThatOfTheirAreas) {
  // A line through a convex box meets a convex part of it with the probability of the areas' ratio, 2/3 here;
  // it meets at least one of the two, so both with 1/3.
  EXPECT_NEAR(leaf_count_variability(TwoHalves().tree), std::sqrt(1.0 / 3.0 * 2.0 / 3.0), 2e-3);
}

TEST(Metrics, OverlapEqualsTheSumOverAllPairs) {
  const Soup soup = random_soup(200, 0.2f, 1);
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  const BinaryTree tree = build_tree(geometry, {});
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

TEST(Metrics, ClippedAreasOfTheCellsOfAGridSumToTheTriangles) {
  const Soup soup = random_soup(50, 1.0f, 2);
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  for (std::uint32_t id = 0; id < geometry.triangle_count(); ++id) {
    const Polygon polygon(geometry.triangle(id));
    double sum = 0.0;
    for (float x = -2; x < 3; x += 0.5f) {
      for (float y = -2; y < 3; y += 0.5f) {
        for (float z = -2; z < 3; z += 0.5f) {
          sum += clip(polygon, Box3f{{x, y, z}, {x + 0.5f, y + 0.5f, z + 0.5f}}).area();
        }
      }
    }
    EXPECT_NEAR(sum, polygon.area(), 1e-12);
  }
}

TEST(Metrics, AreTheSameForAnyNumberOfThreads) {
  const Soup soup = random_soup(3000, 0.1f, 3);
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  const BinaryTree tree = build_tree(geometry, {});
  const double overlap = end_point_overlap(tree, geometry), variability = leaf_count_variability(tree);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(end_point_overlap(tree, geometry), overlap);
  EXPECT_EQ(leaf_count_variability(tree), variability);
}

TEST(Metrics, CountsAddUp) {
  const Soup soup = random_soup(1000, 0.1f, 4);
  const TriangleMesh mesh = soup.mesh();
  const BinaryTree tree = build_tree(Geometry({&mesh, 1}), {});
  const TreeCounts counts = count_tree(tree);
  std::size_t leaves = 0, references = 0;
  for (std::size_t k = 0; k < counts.leaf_sizes.size(); ++k) {
    leaves += counts.leaf_sizes[k];
    references += k * counts.leaf_sizes[k];
  }
  EXPECT_EQ(leaves, counts.leaves);
  EXPECT_EQ(references, counts.references);
  EXPECT_EQ(counts.nodes, 2 * counts.leaves - 1);
  EXPECT_GE(std::size_t{1} << counts.depth, counts.leaves);
}

TEST(Metrics, OfAnEmptyTreeAreZero) {
  const TriangleMesh mesh;
  EXPECT_EQ(surface_area_cost(BinaryTree{}), 0.0);
  EXPECT_EQ(end_point_overlap({}, Geometry({&mesh, 1})), 0.0);
  EXPECT_EQ(leaf_count_variability(BinaryTree{}), 0.0);
}

}  // namespace
}  // namespace kerf
