// What is at a hit in a scene, against the meshes that were built from, moved.
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "support/adversarial.hpp"
#include "support/instrumented.hpp"
#include "support/placed.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using kerf_tests::Leaf;
using kerf_tests::leaves_of;
using kerf_tests::moved_to_scene;

// Half of the scenes stand mirrored.
Scene mirrored_pair(std::mt19937& random, const Bvh& object) {
  const Scene scene = kerf_tests::scene_of_scenes(random, object);
  return build(std::vector<Instance>{
      {.scene = scene}, {.scene = scene, .transform = {{{-1, 0, 0, 3}, {0, 1, 0, 0}, {0, 0, 2, 0}}}}});
}

TEST(SceneGeometry, TrianglesAreThoseOfTheMeshMoved) {
  std::mt19937 random(1);
  const workbench::Solid sphere = workbench::make_sphere(1);
  const Scene scene = mirrored_pair(random, build(sphere.mesh()));
  const std::vector<Leaf> leaves = leaves_of(scene);
  const auto count = static_cast<std::uint32_t>(sphere.triangles.size());
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    for (std::uint32_t k = 0; k < count; k += 7) {
      const auto& [a, b, c] = sphere.triangles[k];
      const Triangle corners{sphere.vertices[a], sphere.vertices[b], sphere.vertices[c]};
      const auto found = scene.triangle({.primitive = k, .mesh = 0, .instance = i});
      ASSERT_EQ(found.has_value(), !leaves[i].object.bounds().empty());
      if (found) {
        ASSERT_EQ(*found, moved_to_scene(leaves[i].transforms, corners));
      }
    }
  }
  EXPECT_FALSE(scene.triangle({.primitive = count, .mesh = 0, .instance = 0}));
  EXPECT_FALSE(scene.triangle({.primitive = 0, .mesh = 1, .instance = 0}));
  EXPECT_FALSE(scene.triangle({.primitive = 0, .mesh = 0, .instance = scene.instance_count()}));
  EXPECT_FALSE(Scene().triangle({}));
}

TEST(SceneGeometry, NormalsAndSidesAreThoseOfTheMovedTriangle) {
  std::mt19937 random(2);
  const Scene scene = mirrored_pair(random, build(workbench::make_sphere(2).mesh()));
  std::size_t hits = 0, fronts = 0;
  for (std::size_t i = 0; i < test::reduced(2000); ++i) {
    Ray ray{.origin = adversarial::uniform_point(random, 20.0f),
            .direction = adversarial::uniform_point(random, 1.0f)};
    const auto hit = scene.intersect(ray);
    if (!hit) continue;
    ++hits;
    const HitGeometry geometry = scene.geometry(ray, *hit);
    ASSERT_EQ(geometry.triangle, *scene.triangle({hit->primitive, hit->mesh, hit->instance}));
    const auto& [a, b, c] = geometry.triangle;
    double e[3], f[3];
    for (int axis = 0; axis < 3; ++axis) {
      e[axis] = double{b[axis]} - a[axis];
      f[axis] = double{c[axis]} - a[axis];
    }
    const double n[3] = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
    const double length = std::hypot(n[0], n[1], n[2]);
    double facing = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(geometry.normal[axis], n[axis] / length, 1e-4);
      facing += ray.direction[axis] * n[axis] / length;
    }
    if (std::abs(facing) < 1e-3) continue;  // along the triangle
    ASSERT_EQ(geometry.front, facing < 0.0);
    fronts += geometry.front;
  }
  EXPECT_GT(hits, test::reduced(200));
  EXPECT_GT(fronts, test::reduced(50));
}

TEST(SceneGeometry, AHitOfNothingHasNone) {
  const Instance instance{.object = build(workbench::make_sphere(1).mesh())};
  const Scene scene = build(std::span(&instance, 1));
  const Ray ray{.origin = {0, 0, -3}, .direction = {0, 0, 1}};
  EXPECT_THROW((void)scene.geometry(ray, {}), Error);
  EXPECT_THROW((void)scene.geometry(ray, {.primitive = 1u << 20, .mesh = 0, .instance = 0}), Error);
}

}  // namespace
}  // namespace kerf
