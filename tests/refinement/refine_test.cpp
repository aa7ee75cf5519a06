// What `Quality::high` and `best` keep of a tree, and what they gain.
#include "refinement/refine.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "build.hpp"
#include "files/checksum.hpp"
#include "support/build_options.hpp"
#include "support/progress.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"
#include "tree/validate.hpp"
#include "workbench/generate/generated_scenes.hpp"

namespace kerf {
namespace {

constexpr Quality qualities[] = {Quality::high, Quality::best};

workbench::Scene make_scene(std::string_view name, double triangles) {
  const workbench::GeneratedScene& scene = *workbench::find_generated_scene(name);
  return scene.generate(triangles / static_cast<double>(scene.default_triangles));
}

// Of the layout, by a definition of its own: see `ReinsertionCosts`.
struct LayoutCost {
  const BinaryTree& tree;
  double sum = 0.0;

  std::size_t visit(std::uint32_t n, bool in_leaf) {
    const std::size_t references = count(n);
    const BinaryNode& node = tree.nodes[n];
    const bool is_leaf = references <= 8;
    if (!in_leaf) sum += (is_leaf ? 3.0 : 1.0) * half_area(node.bounds);
    if (!node.is_leaf()) {
      visit(node.left(), in_leaf || is_leaf);
      visit(node.right(), in_leaf || is_leaf);
    }
    return references;
  }
  std::size_t count(std::uint32_t n) const {
    const BinaryNode& node = tree.nodes[n];
    return node.is_leaf() ? node.count : count(node.left()) + count(node.right());
  }
};

double layout_cost(const BinaryTree& tree) {
  LayoutCost cost{tree};
  cost.visit(0, false);
  return cost.sum / half_area(tree.nodes[0].bounds);
}

std::vector<std::uint32_t> sorted_references(const BinaryTree& tree) {
  std::vector<std::uint32_t> references(tree.references.begin(), tree.references.end());
  std::sort(references.begin(), references.end());
  return references;
}

std::uint64_t checksum_of(const BinaryTree& tree) {
  return checksum(std::as_bytes(std::span(tree.nodes.data(), tree.nodes.size()))) ^
         checksum(std::as_bytes(std::span(tree.references.data(), tree.references.size())));
}

// From points in the box, in all directions.
std::vector<Ray> random_rays(const Box3f& box, std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const Vec3f extent = box.upper - box.lower;
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    for (int axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = box.lower[axis] + uniform(random) * extent[axis];
      ray.direction[axis] = uniform(random) - 0.5f;
    }
  }
  return rays;
}

TEST(Refinement, KeepsReferencesAndValidityOfEveryBuildersTree) {
  const kerf_tests::Mesh mesh = kerf_tests::random_triangles(1500, 0.5f, 0.01f);
  const TriangleMesh view = mesh.mesh();
  const Geometry geometry({&view, 1});
  for (const BuilderInfo& info : builders()) {
    for (const Quality quality : qualities) {
      SCOPED_TRACE(testing::Message() << info.name << ", quality " << static_cast<int>(quality));
      BuildOptions options = spatial_splits_everywhere();
      options.builder = info.builder;
      const BinaryTree before = make_tree(geometry, options);
      options.quality = quality;
      const BinaryTree after = make_tree(geometry, options);
      EXPECT_EQ(validate(after, geometry, max_tree_depth), std::vector<std::string>{});
      EXPECT_EQ(sorted_references(after), sorted_references(before));
      EXPECT_EQ(after.nodes.size(), before.nodes.size());
    }
  }
}

TEST(Refinement, EveryQualityCostsLessThanTheOneBelow) {
  for (const char* const name : {"atrium", "conference", "city", "sticks", "hairball"}) {
    SCOPED_TRACE(name);
    const workbench::Scene scene = make_scene(name, 5000.0);
    const TriangleMesh mesh = scene.mesh();
    const Geometry geometry({&mesh, 1});
    const double fast = layout_cost(make_tree(geometry, {}));
    const double high = layout_cost(make_tree(geometry, {.quality = Quality::high}));
    const double best = layout_cost(make_tree(geometry, {.quality = Quality::best}));
    EXPECT_LT(high, fast);
    EXPECT_LT(best, high);
  }
}

TEST(Refinement, TheTreeIsTheSameForAllThreadsAndInstructionSets) {
  const workbench::Scene scene = make_scene("atrium", 20000.0);
  const TriangleMesh mesh = scene.mesh();
  const Geometry geometry({&mesh, 1});
  for (const Quality quality : qualities) {
    const std::uint64_t expected = checksum_of(make_tree(geometry, {.quality = quality, .threads = 1}));
    for (const unsigned threads : {2u, 7u})
      EXPECT_EQ(checksum_of(make_tree(geometry, {.quality = quality, .threads = threads})), expected);
    kerf_tests::for_each_target(
        [&](const Target&) { EXPECT_EQ(checksum_of(make_tree(geometry, {.quality = quality})), expected); });
  }
}

TEST(Refinement, HitsAreThoseOfTheTreeBefore) {
  const workbench::Scene scene = make_scene("conference", 5000.0);
  const Bvh plain = build(scene.mesh());
  const std::vector<Ray> rays = random_rays(plain.bounds(), 2000);
  for (const Quality quality : qualities) {
    kerf_tests::for_each_target([&](const Target&) {
      const Bvh refined = build(scene.mesh(), {.quality = quality});
      std::size_t hits = 0, different = 0;
      for (const Ray& ray : rays) {
        const auto hit = plain.intersect(ray);
        hits += hit.has_value();
        different += refined.intersect(ray) != hit;
        different += refined.occluded(ray) != hit.has_value();
        different += refined.count_hits(ray) != plain.count_hits(ray);
      }
      EXPECT_GT(hits, rays.size() / 2);
      EXPECT_EQ(different, 0u);
    });
  }
}

TEST(Refinement, TellsItsProgressAndStopsWhenTold) {
  const workbench::Scene scene = make_scene("atrium", 20000.0);
  for (const Quality quality : qualities) {
    // The last word is that of the refinement.
    const float last = kerf_tests::expect_progress_and_cancelling(scene.mesh(), {.quality = quality});
    EXPECT_GT(last, 0.6f) << "the refinement has its share";
  }
}

TEST(Refinement, WithoutTimeStopsAfterOneBatchAndIsStillWhole) {
  const workbench::Scene scene = make_scene("city", 50000.0);
  const TriangleMesh mesh = scene.mesh();
  const Geometry geometry({&mesh, 1});
  const BinaryTree stopped = make_tree(geometry, {.quality = Quality::best, .max_refinement_seconds = 0.0});
  EXPECT_EQ(validate(stopped, geometry, max_tree_depth), std::vector<std::string>{});
  EXPECT_LT(layout_cost(stopped), layout_cost(make_tree(geometry, {})));
  EXPECT_GT(layout_cost(stopped), layout_cost(make_tree(geometry, {.quality = Quality::best})));
}

// Boxes that are all alike make every place as good as any other.
TEST(Refinement, EqualTrianglesAreDoneWithAtOnce) {
  std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 1}, {0, 1, 2}};
  std::vector<std::uint32_t> triangles;
  for (int i = 0; i < 20000; ++i) triangles.insert(triangles.end(), {0, 1, 2});
  const TriangleMesh mesh{.vertices = vertices, .triangles = triangles};
  const Geometry geometry({&mesh, 1});
  const BinaryTree before = make_tree(geometry, {});
  const BinaryTree after = make_tree(geometry, {.quality = Quality::best});
  EXPECT_EQ(checksum_of(after), checksum_of(before));
}

TEST(Refinement, AreasThatOverflowAreLeftAlone) {
  kerf_tests::Mesh mesh = kerf_tests::random_triangles(300, 0.5f, 0.1f);
  for (Vec3f& vertex : mesh.vertices)
    vertex = {vertex.x * 0x1p100f, vertex.y * 0x1p100f, vertex.z * 0x1p100f};
  const TriangleMesh view = mesh.mesh();
  const Geometry geometry({&view, 1});
  EXPECT_EQ(checksum_of(make_tree(geometry, {.quality = Quality::best})),
            checksum_of(make_tree(geometry, {})));
}

TEST(Refinement, SmallTreesStayTrees) {
  for (const std::uint32_t count : {0u, 1u, 2u, 3u, 9u, 20u}) {
    const kerf_tests::Mesh mesh = kerf_tests::random_triangles(count, 0.5f, 0.1f);
    const TriangleMesh view = mesh.mesh();
    const Geometry geometry({&view, 1});
    const BinaryTree tree = make_tree(geometry, {.quality = Quality::best, .max_leaf_size = 1});
    EXPECT_EQ(validate(tree, geometry, max_tree_depth), std::vector<std::string>{}) << count;
    EXPECT_EQ(tree.references.size(), count);
  }
}

}  // namespace
}  // namespace kerf
