// The triangles of a scene in a box against every triangle of every instance, clipped in rational numbers.
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"
#include "support/instrumented.hpp"
#include "support/placed.hpp"
#include "support/targets.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;
using kerf_tests::any_transform;
using kerf_tests::Leaf;
using kerf_tests::leaves_of;
using kerf_tests::moved_to_scene;

std::vector<ScenePrimitiveId> clipped(const std::vector<Leaf>& leaves, const std::vector<Triangle>& triangles,
                                      const Box3f& box) {
  std::vector<ScenePrimitiveId> found;
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    if (leaves[i].object.bounds().empty()) continue;
    for (std::uint32_t k = 0; k < triangles.size(); ++k) {
      if (exact::overlaps(moved_to_scene(leaves[i].transforms, triangles[k]), box))
        found.push_back({.primitive = k, .mesh = 0, .instance = i});
    }
  }
  return found;
}

// Turns by right angles, mirrors and whole numbers: everything is aligned with everything.
Transform on_the_grid(std::mt19937& random) {
  Transform transform{{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}};
  const std::size_t first = random() % 3;
  const Vec3f by = grid_point(random, 4);
  for (std::size_t i = 0; i < 3; ++i) {
    transform.rows[i][(first + i) % 3] = random() % 2 == 0 ? 1.0 : -2.0;
    transform.rows[i][3] = by[static_cast<int>(i)];
  }
  return transform;
}

TEST(SceneBoxes, HoldTheTrianglesOfEveryInstanceThatExactClippingLeaves) {
  kerf_tests::for_each_target([](const Target&) {
    std::mt19937 random(1);
    std::size_t found = 0;
    for (int round = 0; round < 8; ++round) {
      const bool grid = round % 2 == 0;
      const float size = round == 3 ? 1e6f : round == 5 ? 1e-6f : 1.0f;
      const auto point = [&] { return grid ? grid_point(random, 2) : uniform_point(random, 2.0f); };
      const Soup triangles = soup(12, point);
      const Bvh object = build(triangles.mesh(), spatial_splits_everywhere());
      std::vector<Instance> instances;
      for (std::uint32_t i = 0; i < 12; ++i) {
        instances.push_back({.object = i == 5 ? Bvh() : object,
                             .transform = grid ? on_the_grid(random) : any_transform(random, size)});
      }
      const Scene scene = build(instances);
      const std::vector<Leaf> leaves = leaves_of(scene);
      std::vector<Box3f> boxes;
      for (std::size_t i = 0; i < std::max<std::size_t>(test::reduced(24), 4); ++i) {  // each kind once
        const Vec3f a = grid ? grid_point(random, 5) : uniform_point(random, 5.0f * size),
                    b = grid ? grid_point(random, 5) : uniform_point(random, 5.0f * size);
        boxes.push_back({min(a, b), max(a, b)});
        if (i % 4 == 0) boxes.back().upper = boxes.back().lower;  // a point
        if (i % 4 == 1) {                                         // no more than touches a corner
          const Vec3f corner = moved_to_scene({instances[i % 5].transform}, triangles.triangles[i % 12].v1);
          boxes.back() = {corner, corner};
        }
      }
      const Lists<ScenePrimitiveId> all = scene.triangles_in(boxes);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        const std::vector<ScenePrimitiveId> expected = clipped(leaves, triangles.triangles, boxes[i]);
        ASSERT_EQ(scene.triangles_in(boxes[i]), expected) << round;
        ASSERT_TRUE(std::ranges::equal(all[i], expected));
        if (i % 4 == 1) {
          ASSERT_FALSE(expected.empty());
        }
        found += expected.size();
      }
    }
    EXPECT_GT(found, test::reduced(24) == 24 ? 1000u : 0u);
  });
}

TEST(SceneBoxes, HoldTheTrianglesOfScenesInScenes) {
  std::mt19937 random(2);
  const workbench::Solid sphere = workbench::make_sphere(1);
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : sphere.triangles)
    triangles.push_back({sphere.vertices[a], sphere.vertices[b], sphere.vertices[c]});
  const Scene scene = kerf_tests::scene_of_scenes(random, build(sphere.mesh()));
  const std::vector<Leaf> leaves = leaves_of(scene);
  std::size_t found = 0;
  for (std::size_t i = 0; i < test::reduced(40); ++i) {
    const Leaf& leaf = leaves[random() % leaves.size()];
    const Vec3f corner = moved_to_scene(leaf.transforms, triangles[random() % triangles.size()].v0);
    const Box3f box = i % 2 == 0 ? Box3f{corner, corner} : Box3f{corner, corner + Vec3f{0.4f, 0.3f, 0.2f}};
    const std::vector<ScenePrimitiveId> expected = clipped(leaves, triangles, box);
    ASSERT_EQ(scene.triangles_in(box), expected);
    found += expected.size();
  }
  EXPECT_GT(found, test::reduced(100));
}

// An object far from its own origin, and moved back: single precision would lose its place.
TEST(SceneBoxes, HoldTrianglesThatAreMovedFromFarAwayAndFlattened) {
  workbench::Solid sphere = workbench::make_sphere(2);
  for (Vec3f& v : sphere.vertices) v = v + Vec3f{4096, -4096, 8192};
  const Bvh object = build(sphere.mesh());
  const auto count = static_cast<std::uint32_t>(sphere.triangles.size());
  const Instance instances[] = {
      {.object = object, .transform = {{{1, 0, 0, -4096}, {0, 1, 0, 4096}, {0, 0, 1, -8192}}}},
      // Flat as far as floats can tell: corners are at x = 1e9.
      {.object = object, .transform = {{{1e-3, 0, 0, 1e9}, {0, 1, 0, 0}, {0, 0, 1, 0}}}}};
  const Scene scene = build(instances);
  EXPECT_EQ(scene.triangles_in({{-1, -1, -1}, {1, 1, 1}}).size(), count);
  EXPECT_EQ(scene.triangles_in({{1e9f, -5000, 8000}, {1e9f, -4000, 9000}}).size(), count);
  EXPECT_TRUE(scene.triangles_in({{1.0001e9f, -5000, 8000}, {2e9f, -4000, 9000}}).empty());
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(scene.triangles_in({{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}).size(),
            2 * count);
}

TEST(SceneBoxes, QuestionsWithoutSenseHaveNoAnswers) {
  const Instance instance{.object = build(workbench::make_sphere(2).mesh())};
  const Scene scene = build(std::span(&instance, 1));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(scene.triangles_in(Box3f{}).empty());
  EXPECT_TRUE(scene.triangles_in({{nan, 0, 0}, {1, 1, 1}}).empty());
  EXPECT_TRUE(Scene().triangles_in({{0, 0, 0}, {1, 1, 1}}).empty());
}

}  // namespace
}  // namespace kerf
