#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/error.hpp>
#include <tbb/global_control.h>

#include "construction/construct.hpp"
#include "construction/sbvh/parallel_build.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"
#include "tree/measures/counts.hpp"
#include "tree/measures/sah.hpp"
#include "tree/validate.hpp"
#include "workbench/generate/solids.hpp"

namespace {

using kerf::BinaryTree;
using kerf::Builder;
using kerf::BuildOptions;
using kerf_tests::Mesh;
using kerf_tests::random_triangles;

BinaryTree tree_of(const kerf::TriangleMesh& mesh, const BuildOptions& options = {}) {
  return kerf::construct(kerf::Geometry(std::span(&mesh, 1)), options);
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

// Triangle i has size 2^-i: every split by the heuristic separates the largest from all others.
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

Mesh large_and_small_triangles() {
  Mesh mesh = random_triangles(20'000, 0.02f, 0.02f);
  const Mesh large = random_triangles(300, 0.7f, 0.7f, 2);
  for (const auto& [a, b, c] : large.triangles) mesh.triangles.push_back({a + 60000, b + 60000, c + 60000});
  mesh.vertices.insert(mesh.vertices.end(), large.vertices.begin(), large.vertices.end());
  for (kerf::Vec3f& v : mesh.vertices)
    v = v - kerf::Vec3f{0.5f, 0.5f, 0.5f};  // planes at zero, of either sign
  return mesh;
}

TEST(SplitBvh, AnyNumberOfThreadsBuildsTheSameTree) {
  const tbb::global_control eight_threads(tbb::global_control::max_allowed_parallelism, 8);
  const Mesh mesh = large_and_small_triangles();
  const BinaryTree tree = tree_of(mesh.mesh(), {.threads = 1});
  for (const unsigned threads : {1u, 2u, 4u, 8u})
    expect_equal(tree, tree_of(mesh.mesh(), {.threads = threads}));
}

TEST(SplitBvh, AnyInstructionSetBuildsTheSameTree) {
  const Mesh mesh = large_and_small_triangles();
  const BinaryTree tree = tree_of(mesh.mesh());
  kerf_tests::for_each_target([&](const kerf::Target&) { expect_equal(tree, tree_of(mesh.mesh())); });
}

TEST(SplitBvh, ProgressOnlyGrowsAndReachesTheEnd) {
  const Mesh mesh = large_and_small_triangles();
  std::vector<float> fractions;
  tree_of(mesh.mesh(), {.progress = [&fractions](float fraction) {
            fractions.push_back(fraction);
            return true;
          }});
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GE(fractions.front(), 0.0f);
  EXPECT_LE(fractions.back(), 1.0f);
}

TEST(SplitBvh, ProgressCanCancel) {
  const Mesh mesh = large_and_small_triangles();
  for (const unsigned threads : {1u, 4u}) {
    int calls = 0;
    try {
      tree_of(mesh.mesh(), {.threads = threads, .progress = [&calls](float) { return ++calls < 2; }});
      ADD_FAILURE() << "the build went on";
    } catch (const kerf::Error& error) {
      EXPECT_EQ(error.code(), kerf::Error::cancelled);
    }
    EXPECT_EQ(calls, 2);
  }
}

TEST(SplitBvh, PeakOfATreeIsNoMoreThanItsBound) {
  const Mesh mesh = large_and_small_triangles();
  for (const float ratio : {1.0f, 1.1f, 1.5f, 3.0f}) {
    const BinaryTree tree = tree_of(mesh.mesh(), {.max_reference_ratio = ratio, .threads = 1});
    EXPECT_GT(tree.build_peak_bytes, tree.nodes.size() * sizeof(kerf::BinaryNode));
    EXPECT_LE(tree.build_peak_bytes,
              kerf::tree_memory_bound(mesh.triangles.size(), {.max_reference_ratio = ratio, .threads = 1}));
  }
}

// The oracle tries every plane between neighbouring centroids on every axis, one box at a time.
TEST(SplitBvh, SmallNodesTakeTheCheapestOfAllObjectSplits) {
  for (std::uint32_t count = 2; count <= 16; ++count) {
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
      const Mesh mesh = random_triangles(count, 0.3f, 0.3f, seed);
      const kerf::TriangleMesh view = mesh.mesh();
      const kerf::Geometry geometry(std::span(&view, 1));
      std::vector<kerf::Box3f> boxes;
      for (std::uint32_t i = 0; i < count; ++i) boxes.push_back(kerf::bounds_of(geometry.triangle(i)));
      float cheapest = std::numeric_limits<float>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        std::sort(boxes.begin(), boxes.end(), [axis](const kerf::Box3f& a, const kerf::Box3f& b) {
          return a.lower[axis] + a.upper[axis] < b.lower[axis] + b.upper[axis];
        });
        for (std::uint32_t left = 1; left < count; ++left) {
          kerf::Box3f sides[2];
          for (std::uint32_t i = 0; i < count; ++i)
            sides[i < left ? 0 : 1] = merge(sides[i < left ? 0 : 1], boxes[i]);
          cheapest = std::min(cheapest, half_area(sides[0]) * static_cast<float>(left) +
                                            half_area(sides[1]) * static_cast<float>(count - left));
        }
      }
      const BinaryTree tree = tree_of(view, {.builder = Builder::bvh, .max_leaf_size = 1});
      std::size_t left = 0;  // references under the root's left child
      std::vector<std::uint32_t> stack{tree.nodes[0].left()};
      while (!stack.empty()) {
        const kerf::BinaryNode& node = tree.nodes[stack.back()];
        stack.pop_back();
        left += node.count;
        if (!node.is_leaf()) stack.insert(stack.end(), {node.left(), node.right()});
      }
      const float cost = half_area(tree.nodes[1].bounds) * static_cast<float>(left) +
                         half_area(tree.nodes[2].bounds) * static_cast<float>(count - left);
      EXPECT_FLOAT_EQ(cost, cheapest) << count << " triangles, seed " << seed;
    }
  }
}

}  // namespace
