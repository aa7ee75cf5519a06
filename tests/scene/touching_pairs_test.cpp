// Scenes that touch others and themselves, against every pair of triangles of every two instances.
#include <algorithm>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "math/triangle_pair.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_pairs.hpp"
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

std::vector<Triangle> triangles_of(const workbench::Solid& solid) {
  std::vector<Triangle> all;
  for (const auto& [a, b, c] : solid.triangles)
    all.push_back({solid.vertices[a], solid.vertices[b], solid.vertices[c]});
  return all;
}

// The triangles of each instance, moved to the scene, and then by `transform`.
std::vector<std::vector<Triangle>> flattened(const Scene& scene, const std::vector<Triangle>& triangles,
                                             const Transform& transform = {}) {
  std::vector<std::vector<Triangle>> all;
  for (Leaf leaf : leaves_of(scene)) {
    all.emplace_back();
    if (leaf.object.bounds().empty()) continue;
    leaf.transforms.insert(leaf.transforms.begin(), transform);
    for (const Triangle& triangle : triangles)
      all.back().push_back(moved_to_scene(leaf.transforms, triangle));
  }
  return all;
}

template <class Touch>
std::vector<SceneTouchingPair> one_by_one(const std::vector<std::vector<Triangle>>& first,
                                          const std::vector<std::vector<Triangle>>& second, bool is_itself,
                                          const Touch& touch) {
  std::vector<SceneTouchingPair> pairs;
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    for (std::uint32_t a = 0; a < first[i].size(); ++a) {
      for (std::uint32_t j = is_itself ? i + 1 : 0; j < second.size(); ++j) {
        for (std::uint32_t b = 0; b < second[j].size(); ++b)
          if (touch(first[i][a], second[j][b])) pairs.push_back({{a, 0, i}, {b, 0, j}});
      }
    }
  }
  return pairs;
}

// Turns by right angles, mirrors and powers of two: floats hold all of it, in every object's space.
Transform on_the_grid(std::mt19937& random, int half) {
  Transform transform{{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}};
  const std::size_t first = random() % 3;
  const Vec3f by = grid_point(random, half);
  for (std::size_t i = 0; i < 3; ++i) {
    transform.rows[i][(first + i) % 3] = random() % 2 == 0 ? 1.0 : -2.0;
    transform.rows[i][3] = by[static_cast<int>(i)];
  }
  return transform;
}

TEST(SceneTouchingPairs, AreThoseOfRationalArithmeticOnAGrid) {
  std::mt19937 random(1);
  for (std::size_t round = 0; round < test::reduced(3); ++round) {
    const Soup soup_of_object = soup(6, [&] { return grid_point(random, 2); });
    const std::vector<Triangle>& triangles = soup_of_object.triangles;
    std::vector<Transform> transforms;
    for (int i = 0; i < 8; ++i) transforms.push_back(on_the_grid(random, 4));
    const Transform moved = on_the_grid(random, 3);
    kerf_tests::for_each_target([&](const Target&) {
      const Bvh object = build(soup_of_object.mesh(), spatial_splits_everywhere());
      std::vector<Instance> first, second;
      for (std::size_t i = 0; i < transforms.size(); ++i)
        (i < 5 ? first : second).push_back({.object = object, .transform = transforms[i]});
      const Scene scene = build(first), other = build(second);
      const auto flat = flattened(scene, triangles);
      const std::vector<SceneTouchingPair> expected =
          one_by_one(flat, flattened(other, triangles, moved), false, exact::touch);
      EXPECT_EQ(scene.touching_pairs(other, moved), expected);
      EXPECT_EQ(scene.touches(other, moved), !expected.empty());
      const std::vector<SceneTouchingPair> own = one_by_one(flat, flat, true, exact::touch);
      EXPECT_GT(own.size(), 10u);
      EXPECT_EQ(scene.touching_pairs(), own);
    });
  }
}

TEST(SceneTouchingPairs, AreThoseOfEveryTwoInstancesUnderAnyTransform) {
  std::mt19937 random(2);
  const workbench::Solid sphere = workbench::make_sphere(1);
  const Bvh object = build(sphere.mesh(), spatial_splits_everywhere());
  const std::vector<Triangle> triangles = triangles_of(sphere);
  const Scene scene = kerf_tests::scene_of_scenes(random, object);
  const auto flat = flattened(scene, triangles);
  const std::vector<SceneTouchingPair> own = one_by_one(flat, flat, true, triangles_touch);
  EXPECT_GT(own.size(), 300u);
  EXPECT_EQ(scene.touching_pairs(), own);
  EXPECT_EQ(scene.touching_pairs({.threads = 1}), own);

  std::vector<Instance> instances;
  for (int i = 0; i < 6; ++i) instances.push_back({.object = object, .transform = any_transform(random, 2)});
  const Scene other = build(instances);
  std::size_t pairs = 0;
  for (std::size_t round = 0; round < test::reduced(4); ++round) {
    const Transform transform = round == 0 ? Transform{} : any_transform(random, 3);
    const std::vector<SceneTouchingPair> expected =
        one_by_one(flat, flattened(other, triangles, transform), false, triangles_touch);
    ASSERT_EQ(scene.touching_pairs(other, transform), expected);
    ASSERT_EQ(scene.touches(other, transform), !expected.empty());
    pairs += expected.size();
  }
  EXPECT_GT(pairs, 0u);
}

TEST(SceneTouchingPairs, AHierarchyIsInstanceZeroOfTheOther) {
  std::mt19937 random(3);
  const Bvh torus = build(workbench::make_torus(16, 8).mesh()),
            sphere = build(workbench::make_sphere(2, 0.6f).mesh());
  const Scene scene = build(std::vector<Instance>{{.object = sphere}, {.object = torus}});
  for (int round = 0; round < 6; ++round) {
    const Transform transform = any_transform(random, 0.3f);
    std::vector<SceneTouchingPair> expected;
    std::uint32_t number = 0;
    for (const Bvh& object : {sphere, torus}) {
      for (const auto& [a, b] : object.touching_pairs(sphere, transform))
        expected.push_back({{a.primitive, a.mesh, number}, {b.primitive, b.mesh, 0}});
      ++number;
    }
    ASSERT_EQ(scene.touching_pairs(sphere, transform), expected);
    ASSERT_EQ(scene.touches(sphere, transform), !expected.empty());
  }
}

// Corners of the second are rounded in the space of a first that is a thousandth, or a millionth, of its
// size: what they are rounded by is more than the boxes of the first are grown by.
TEST(SceneTouchingPairs, AreThoseOfTheObjectsHoweverMuchLargerTheSecondIs) {
  std::mt19937 random(4);
  const Bvh grain = build(workbench::make_sphere(2).mesh()), hall = build(workbench::make_sphere(3).mesh());
  std::size_t pairs = 0;
  for (const double size : {1.0, 1e-3, 1e-6}) {
    std::vector<Instance> grains;
    for (std::size_t i = 0; i < test::reduced(200); ++i) {
      Vec3f on_wall = uniform_point(random, 1);
      on_wall = (0.99f / length(on_wall)) * on_wall;  // not quite: it has flat walls
      grains.push_back(
          {.object = grain,
           .transform = {{{size, 0, 0, on_wall.x}, {0, size, 0, on_wall.y}, {0, 0, size, on_wall.z}}}});
    }
    const Scene scene = build(grains);
    std::vector<SceneTouchingPair> expected;
    for (std::uint32_t i = 0; i < grains.size(); ++i) {
      Transform back;
      for (int axis = 0; axis < 3; ++axis) {
        back.rows[axis][axis] = 1.0 / size;
        back.rows[axis][3] = 1.0 / size * -grains[i].transform.rows[axis][3];
      }
      for (const auto& [a, b] : grain.touching_pairs(hall, back))
        expected.push_back({{a.primitive, 0, i}, {b.primitive, 0, 0}});
    }
    ASSERT_EQ(scene.touching_pairs(hall), expected) << size;
    pairs += expected.size();
  }
  EXPECT_GT(pairs, 0u);
}

TEST(SceneTouchingPairs, StackedBricksTouchTheirNeighbours) {
  const Bvh brick = build(workbench::make_box({0, 0, 0}, {1, 1, 1}).mesh());
  std::vector<Instance> row;
  for (int i = 0; i < 50; ++i)
    row.push_back({.object = brick, .transform = {{{1, 0, 0, 1.0 * i}, {0, 1, 0, 0}, {0, 0, 1, 0}}}});
  std::vector<std::pair<std::uint32_t, std::uint32_t>> touching;
  for (const SceneTouchingPair& pair : build(row).touching_pairs()) {
    const std::pair both(pair.first.instance, pair.second.instance);
    if (touching.empty() || touching.back() != both) touching.push_back(both);
  }
  std::sort(touching.begin(), touching.end());
  touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
  ASSERT_EQ(touching.size(), 49u);
  for (std::uint32_t i = 0; i < 49; ++i) EXPECT_EQ(touching[i], std::pair(i, i + 1));
}

TEST(SceneTouchingPairs, TheOtherMayBeFlattenedAndWhatHasNoSenseIsRefused) {
  const Instance cube{.object = build(workbench::make_box({0, 0, 0}, {1, 1, 1}).mesh())};
  const Scene scene = build(std::span(&cube, 1));
  const auto to_point = [](double x) { return Transform{{{0, 0, 0, x}, {0, 0, 0, 0.5}, {0, 0, 0, 0.5}}}; };
  EXPECT_TRUE(scene.touches(scene, to_point(1)));
  EXPECT_FALSE(scene.touches(scene, to_point(0.5)));
  EXPECT_FALSE(scene.touching_pairs(scene, to_point(1)).empty());
  Transform wrong;
  wrong.rows[1][3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(scene.touches(scene, wrong), Error);
  EXPECT_THROW(scene.touching_pairs(scene, wrong), Error);
  EXPECT_THROW(scene.touching_pairs(scene, {{{1e38, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}), Error);
  EXPECT_TRUE(scene.touching_pairs(Scene()).empty());
  EXPECT_TRUE(Scene().touching_pairs(scene).empty());
  EXPECT_TRUE(scene.touching_pairs(Bvh()).empty());
  EXPECT_TRUE(Scene().touching_pairs().empty());
  EXPECT_TRUE(scene.touching_pairs().empty()) << "one instance";
}

}  // namespace
}  // namespace kerf
