#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "build/build_tree.hpp"
#include "random_triangles.hpp"
#include "tree/metrics.hpp"
#include "tree/validate.hpp"
#include "workbench/solids.hpp"

namespace {

using kerf::BinaryTree;
using kerf::Builder;
using kerf::BuildOptions;
using kerf_tests::Mesh;
using kerf_tests::random_triangles;

BinaryTree tree_of(const kerf::TriangleMesh& mesh, const BuildOptions& options = {}) {
  return kerf::build_tree(kerf::Geometry(std::span(&mesh, 1)), options);
}

std::vector<std::string> findings(const BinaryTree& tree, const kerf::TriangleMesh& mesh) {
  return kerf::validate(tree, kerf::Geometry(std::span(&mesh, 1)), kerf::max_tree_depth);
}

void expect_equal(const BinaryTree& a, const BinaryTree& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(kerf::BinaryNode)), 0);
  EXPECT_EQ(a.references, b.references);
}

const Mesh& sticks() {
  static const Mesh mesh = random_triangles(3000, 0.5f, 0.01f);
  return mesh;
}

TEST(SplitBvh, LeavesCoverEveryPartOfTheirTriangles) {
  for (const float alpha : {0.0f, 1e-5f, 1.0f}) {
    const BinaryTree tree = tree_of(sticks().mesh(), {.alpha = alpha, .max_reference_ratio = 4.0f});
    EXPECT_EQ(findings(tree, sticks().mesh()), std::vector<std::string>{}) << alpha;
  }
}

TEST(SplitBvh, LeavesCoverTrianglesFarFromTheOrigin) {
  const Mesh mesh = random_triangles(500, 0.5f, 0.01f, 3, {1000, -5000, 0});
  const BinaryTree tree = tree_of(mesh.mesh(), {.alpha = 0.0f, .max_reference_ratio = 8.0f});
  EXPECT_EQ(findings(tree, mesh.mesh()), std::vector<std::string>{});
}

TEST(SplitBvh, AlphaOneEqualsObjectSplitTree) {
  expect_equal(tree_of(sticks().mesh(), {.alpha = 1.0f}),
               tree_of(sticks().mesh(), {.builder = Builder::bvh}));
}

TEST(SplitBvh, RatioOneEqualsObjectSplitTree) {
  expect_equal(tree_of(sticks().mesh(), {.max_reference_ratio = 1.0f}),
               tree_of(sticks().mesh(), {.builder = Builder::bvh}));
}

TEST(SplitBvh, ObjectSplitTreeReferencesEveryTriangleOnce) {
  BinaryTree tree = tree_of(sticks().mesh(), {.builder = Builder::bvh});
  EXPECT_EQ(findings(tree, sticks().mesh()), std::vector<std::string>{});
  std::sort(tree.references.begin(), tree.references.end());
  ASSERT_EQ(tree.references.size(), sticks().triangles.size());
  for (std::uint32_t i = 0; i < tree.references.size(); ++i) ASSERT_EQ(tree.references[i], i);
}

// The paper's case: large triangles that lie across the axes beside many small ones.
TEST(SplitBvh, SpatialSplitsPayWhereLargeTrianglesStandAmongSmallOnes) {
  Mesh mesh = random_triangles(3000, 0.02f, 0.02f);
  const Mesh large = random_triangles(100, 0.7f, 0.7f, 2);
  for (const auto& [a, b, c] : large.triangles) mesh.triangles.push_back({a + 9000, b + 9000, c + 9000});
  mesh.vertices.insert(mesh.vertices.end(), large.vertices.begin(), large.vertices.end());
  const BinaryTree without = tree_of(mesh.mesh(), {.builder = Builder::bvh});
  const BinaryTree with = tree_of(mesh.mesh(), {.max_reference_ratio = 4.0f});
  EXPECT_GT(with.references.size(), mesh.triangles.size());
  EXPECT_LT(kerf::surface_area_cost(with), 0.8 * kerf::surface_area_cost(without));
  EXPECT_EQ(findings(with, mesh.mesh()), std::vector<std::string>{});
}

TEST(SplitBvh, SmallerAlphaMeansMoreReferencesAndLowerCost) {
  double cost = kerf::surface_area_cost(tree_of(sticks().mesh(), {.alpha = 1.0f}));
  std::size_t references = sticks().triangles.size();
  for (const float alpha : {1e-2f, 1e-4f, 0.0f}) {
    const BinaryTree tree = tree_of(sticks().mesh(), {.alpha = alpha, .max_reference_ratio = 16.0f});
    EXPECT_LT(kerf::surface_area_cost(tree), cost * 1.001) << alpha;
    EXPECT_GE(tree.references.size(), references) << alpha;
    cost = kerf::surface_area_cost(tree);
    references = tree.references.size();
  }
}

TEST(SplitBvh, ReferencesStayWithinTheirBudget) {
  for (const float ratio : {1.0f, 1.01f, 1.1f, 1.5f, 3.0f, 16.0f}) {
    const BinaryTree tree = tree_of(sticks().mesh(), {.alpha = 0.0f, .max_reference_ratio = ratio});
    EXPECT_LE(static_cast<double>(tree.references.size()),
              static_cast<double>(sticks().triangles.size()) * double{ratio});
    EXPECT_EQ(findings(tree, sticks().mesh()), std::vector<std::string>{});
  }
}

TEST(SplitBvh, DoesNotHurtAnEvenlyTessellatedSphere) {
  const workbench::Solid sphere = workbench::make_sphere(5);
  const double with = kerf::surface_area_cost(tree_of(sphere.mesh()));
  const double without = kerf::surface_area_cost(tree_of(sphere.mesh(), {.builder = Builder::bvh}));
  EXPECT_LE(with, 1.005 * without);
}

TEST(SplitBvh, LeavesHoldNoMoreThanAskedFor) {
  for (const std::uint32_t size : {1u, 3u, 8u}) {
    const BinaryTree tree = tree_of(sticks().mesh(), {.max_leaf_size = size});
    for (const kerf::BinaryNode& node : tree.nodes) {
      if (node.is_leaf()) {
        EXPECT_LE(node.count, size);
      }
    }
  }
}

TEST(SplitBvh, ManyIdenticalTrianglesMakeABalancedTree) {
  Mesh mesh = random_triangles(1, 1.0f, 1.0f);
  mesh.triangles.resize(100'000, mesh.triangles.front());
  const BinaryTree tree = tree_of(mesh.mesh());
  const kerf::TreeCounts counts = kerf::count_tree(tree);
  EXPECT_LE(counts.depth, 20u);
  EXPECT_GE(counts.references, mesh.triangles.size());
}

// Triangle i is of size 2^-i: every split by the heuristic parts the largest from all others.
TEST(SplitBvh, DepthIsBoundedWhereEverySplitIsLopsided) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 120; ++i) {
    for (std::uint32_t copy = 0; copy < 9; ++copy) {
      const float size = std::ldexp(1.0f, -static_cast<int>(i));
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), {{size, 0, 0}, {0, size, 0}, {0, 0, size}});
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
  }
  for (const Builder builder : {Builder::bvh, Builder::sbvh}) {
    const BinaryTree tree = tree_of(mesh.mesh(), {.builder = builder, .alpha = 0.0f, .max_leaf_size = 1});
    EXPECT_EQ(findings(tree, mesh.mesh()).size(), 0u);
    EXPECT_LE(kerf::count_tree(tree).depth, kerf::max_tree_depth);
  }
}

TEST(SplitBvh, CoplanarTrianglesBuild) {
  Mesh mesh = random_triangles(2000, 0.3f, 0.3f);
  for (kerf::Vec3f& v : mesh.vertices) v.z = 0.25f;
  EXPECT_EQ(findings(tree_of(mesh.mesh(), {.alpha = 0.0f}), mesh.mesh()), std::vector<std::string>{});
}

// Scaling by a power of two is exact, so the tree must be the same one.
TEST(SplitBvh, ScaleDoesNotChangeTheTree) {
  const BinaryTree tree = tree_of(sticks().mesh());
  for (const int exponent : {-30, 30}) {
    Mesh mesh = sticks();
    for (kerf::Vec3f& v : mesh.vertices) v = v * std::ldexp(1.0f, exponent);
    const BinaryTree scaled = tree_of(mesh.mesh());
    EXPECT_EQ(scaled.references, tree.references);
    EXPECT_EQ(scaled.nodes.size(), tree.nodes.size());
  }
}

TEST(SplitBvh, CoordinatesNearTheEndsOfTheRangeBuild) {
  for (const float scale : {1e-37f, 1e-20f, 1e20f, 1e37f}) {
    Mesh mesh = random_triangles(300, 0.5f, 0.1f);
    for (kerf::Vec3f& v : mesh.vertices) v = v * scale;
    const BinaryTree tree = tree_of(mesh.mesh(), {.alpha = 0.0f});
    EXPECT_EQ(findings(tree, mesh.mesh()), std::vector<std::string>{}) << scale;
  }
}

TEST(SplitBvh, SameInputGivesTheSameTree) {
  expect_equal(tree_of(sticks().mesh()), tree_of(sticks().mesh()));
}

}  // namespace
