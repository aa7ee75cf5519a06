// What tools see between the stages is what `build` does.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>

#include "support/adversarial.hpp"
#include "support/random_triangles.hpp"

namespace kerf {
namespace {

// Two meshes with an empty one between them. Some triangles are degenerate.
class Inspect : public testing::Test {
 protected:
  Inspect() { second.triangles.insert(second.triangles.end(), {{0, 0, 1}, {3, 3, 3}}); }

  kerf_tests::Mesh first = kerf_tests::random_triangles(400, 0.5f, 0.05f, 1);
  kerf_tests::Mesh second = kerf_tests::random_triangles(300, 0.5f, 0.05f, 2);
  BuildOptions options{.alpha = 0.0f, .max_reference_ratio = 3.0f};

  std::vector<TriangleMesh> meshes() const { return {first.mesh(), {}, second.mesh()}; }
};

TEST_F(Inspect, BuildIsBuildTreeAndMakeBvh) {
  const Bvh whole = build(meshes(), options), stages = make_bvh(build_tree(meshes(), options));
  EXPECT_EQ(stages.bounds(), whole.bounds());
  EXPECT_EQ(stages.statistics().triangles, whole.statistics().triangles);
  EXPECT_EQ(stages.statistics().degenerate_triangles, whole.statistics().degenerate_triangles);
  EXPECT_EQ(stages.statistics().references, whole.statistics().references);
  EXPECT_EQ(stages.statistics().bytes, whole.statistics().bytes);
  const Layout a = layout(whole), b = layout(stages);
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.node_count, b.node_count);
  EXPECT_EQ(std::memcmp(a.nodes, b.nodes, std::size_t{32} * a.width * a.node_count), 0);
  EXPECT_TRUE(std::equal(a.leaves.begin(), a.leaves.end(), b.leaves.begin(), b.leaves.end()));
}

TEST_F(Inspect, TheTreeKnowsItsTriangles) {
  const Tree tree = build_tree(meshes(), options);
  EXPECT_EQ(tree.triangles(), 702u);
  EXPECT_EQ(tree.degenerate_triangles(), 2u);
  EXPECT_EQ(tree.locate(399), (PrimitiveId{399, 0}));
  EXPECT_EQ(tree.locate(400), (PrimitiveId{0, 2}));
  EXPECT_EQ(tree.triangle(401).v2, second.vertices[5]);
  const TreeCounts counts = count_tree(tree);
  EXPECT_EQ(counts.nodes, tree.nodes().size());
  EXPECT_EQ(counts.references, tree.references().size());
  EXPECT_GT(surface_area_cost(tree), 1.0);
  EXPECT_GT(end_point_overlap(tree), 0.0);
  EXPECT_GT(leaf_count_variability(tree), 0.0);
}

TEST_F(Inspect, ATreeOfNothingHasNothing) {
  for (const Tree& tree : {Tree(), build_tree(TriangleMesh{})}) {
    EXPECT_TRUE(tree.nodes().empty());
    EXPECT_EQ(tree.triangles(), 0u);
    EXPECT_EQ(surface_area_cost(tree), 0.0);
    EXPECT_EQ(end_point_overlap(tree), 0.0);
    EXPECT_TRUE(make_bvh(tree).bounds().empty());
  }
  EXPECT_EQ(layout(Bvh()).node_count, 0u);
  EXPECT_TRUE(instruction_set(Bvh()).empty());
}

TEST_F(Inspect, BadInputIsRefusedAsByBuild) {
  first.triangles[3][1] = 100'000;
  EXPECT_THROW(build_tree(meshes()), Error);
  EXPECT_THROW(build_tree(second.mesh(), {.alpha = -1.0f}), Error);
}

TEST_F(Inspect, LeavesHoldTheTrianglesOfTheMeshes) {
  const Bvh bvh = build(meshes(), options);
  const Layout arrays = layout(bvh);
  std::map<std::uint32_t, std::size_t> times;
  visit_triangles(arrays, [&](std::uint32_t id, const Triangle& triangle) {
    ++times[id];
    const PrimitiveId place = locate(arrays.first_triangles, id);
    const kerf_tests::Mesh& mesh = place.mesh == 0 ? first : second;
    const auto& [a, b, c] = mesh.triangles[place.primitive];
    EXPECT_EQ(triangle, (Triangle{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}));
  });
  EXPECT_EQ(times.size(), 700u);
  std::size_t references = 0;
  for (const auto& [id, count] : times) references += count;
  EXPECT_EQ(references, bvh.statistics().references);
  EXPECT_GT(references, times.size());
}

TEST_F(Inspect, CountedRaysHitAsOthersDo) {
  const Bvh bvh = build(meshes(), options);
  std::mt19937 random(5);
  TraversalCounters counters;
  for (int i = 0; i < 200; ++i) {
    const Ray ray{.origin = adversarial::uniform_point(random, 2.0f),
                  .direction = adversarial::uniform_point(random, 1.0f)};
    EXPECT_EQ(intersect(bvh, ray, counters), bvh.intersect(ray));
    EXPECT_EQ(occluded(bvh, ray, counters), bvh.occluded(ray));
  }
  EXPECT_GT(counters.steps, 0u);
  EXPECT_GT(counters.leaves, 0u);
  EXPECT_GE(counters.triangle_tests, counters.leaves);
}

// Rays of all lengths, along the axes, from and through vertices, with ranges that end at hits.
TEST_F(Inspect, BinaryTreesAreHitWhereHierarchiesAre) {
  for (const BuilderInfo& info : builders()) {
    SCOPED_TRACE(info.name);
    BuildOptions with = options;
    with.builder = info.builder;
    const Tree tree = build_tree(meshes(), with);
    const Bvh bvh = make_bvh(tree);
    std::mt19937 random(7);
    TraversalCounters counters, wide;
    std::size_t hits = 0;
    for (int i = 0; i < 3000; ++i) {
      Ray ray{.origin = adversarial::uniform_point(random, 1.5f),
              .direction = adversarial::uniform_point(random, 1.0f)};
      if (i % 3 == 0) ray.direction = first.vertices[random() % first.vertices.size()] - ray.origin;
      if (i % 5 == 0) ray.origin = second.vertices[random() % second.vertices.size()];
      if (i % 7 == 0) ray.direction[static_cast<int>(random() % 3)] = 0.0f;
      if (i % 11 == 0) ray.direction = std::ldexp(1.0f, i % 240 - 120) * ray.direction;
      const auto hit = bvh.intersect(ray);
      if (hit && i % 2 == 0) (i % 4 == 0 ? ray.t_max : ray.t_min) = hit->t;
      const auto expected = bvh.intersect(ray);
      hits += expected.has_value();
      EXPECT_EQ(intersect(tree, ray, counters), expected);
      EXPECT_EQ(occluded(tree, ray, counters), bvh.occluded(ray));
      (void)intersect(bvh, ray, wide);
    }
    EXPECT_GT(hits, 500u);
    EXPECT_GT(counters.steps, wide.steps) << "a wide step does the work of several";
  }
  TraversalCounters counters;
  EXPECT_FALSE(intersect(Tree(), Ray{.origin = {}, .direction = {0, 0, 1}}, counters));
  EXPECT_FALSE(occluded(Tree(), Ray{.origin = {}, .direction = {0, 0, 1}}, counters));
}

TEST_F(Inspect, JoinedMeshesAreOne) {
  const Bvh bvh = build(meshes(), options), joined = join_meshes(bvh);
  EXPECT_EQ(layout(joined).nodes, layout(bvh).nodes);
  std::mt19937 random(6);
  std::size_t hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Ray ray{.origin = adversarial::uniform_point(random, 2.0f),
                  .direction = adversarial::uniform_point(random, 1.0f)};
    auto hit = bvh.intersect(ray);
    if (hit) {
      ++hits;
      hit->primitive += layout(bvh).first_triangles[hit->mesh];
      hit->mesh = 0;
    }
    EXPECT_EQ(joined.intersect(ray), hit);
  }
  EXPECT_GT(hits, 10u);
}

TEST_F(Inspect, StepsCanBeRepeated) {
  const Bvh bvh = build(meshes(), options);
  const Ray ray{.origin = {0.5f, 0.5f, -1.0f}, .direction = {0.01f, 0.01f, 1.0f}};
  repeat_node_steps(bvh, ray, 10);
  const Layout arrays = layout(bvh);
  for (std::uint32_t slot = 0; slot < arrays.width; ++slot) {
    if (const ChildLink child = arrays.child(0, slot); child.is_leaf())
      repeat_leaf_tests(bvh, ray, child, 10);
  }
  EXPECT_EQ(instruction_set(bvh), instruction_set());
}

}  // namespace
}  // namespace kerf
