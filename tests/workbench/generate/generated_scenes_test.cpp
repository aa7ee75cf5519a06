#include "workbench/generate/generated_scenes.hpp"

#include <bit>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/rays/camera.hpp"

namespace workbench {
namespace {

using namespace kerf;

TEST(GeneratedScenes, HaveTheTriangleCountsThatAreListed) {
  for (const GeneratedScene& generated : generated_scenes()) {
    SCOPED_TRACE(generated.name);
    const Scene scene = generated.generate(1.0);
    EXPECT_EQ(scene.triangles.size(), generated.default_triangles);
    EXPECT_GE(scene.triangles.size(), 50'000u);
    EXPECT_LE(scene.triangles.size(), 300'000u);
    EXPECT_GE(scene.viewpoints.size(), 3u);
  }
}

TEST(GeneratedScenes, AreTheSameEveryTimeAndValid) {
  for (const GeneratedScene& generated : generated_scenes()) {
    SCOPED_TRACE(generated.name);
    const Scene first = generated.generate(0.05), second = generated.generate(0.05);
    EXPECT_EQ(first.vertices, second.vertices);
    EXPECT_EQ(first.triangles, second.triangles);
    for (const Vec3f& vertex : first.vertices) ASSERT_TRUE(is_finite(vertex));
    for (const auto& triangle : first.triangles) {
      for (const std::uint32_t vertex : triangle) ASSERT_LT(vertex, first.vertices.size());
    }
  }
}

TEST(GeneratedScenes, GrowWithDetail) {
  for (const GeneratedScene& generated : generated_scenes()) {
    SCOPED_TRACE(generated.name);
    const auto once = static_cast<double>(generated.default_triangles);
    const auto threefold = static_cast<double>(generated.generate(3.0).triangles.size());
    const auto hundredth = static_cast<double>(generated.generate(0.01).triangles.size());
    EXPECT_GT(threefold, 1.9 * once);
    EXPECT_LT(threefold, 4.0 * once);
    EXPECT_LT(hundredth, 0.25 * once);
    EXPECT_GT(hundredth, 0.0);
  }
}

// Positions of vertices, hashed bit by bit: what another machine, compiler or library must give as well.
TEST(GeneratedScenes, AreTheSameOnEveryMachine) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
  for (const GeneratedScene& generated : generated_scenes()) {
    for (const Vec3f& vertex : generated.generate(0.02).vertices) {
      for (int axis = 0; axis < 3; ++axis)
        hash = (hash ^ std::bit_cast<std::uint32_t>(vertex[axis])) * 0x100000001b3u;
    }
  }
  EXPECT_EQ(hash, 1725888714449570221u);
}

TEST(GeneratedScenes, FillTheViewFromEveryViewpoint) {
  constexpr std::size_t side = 24;
  for (const GeneratedScene& generated : generated_scenes()) {
    const Scene scene = generated.generate(1.0);
    const Bvh bvh = build(scene.mesh(), {.builder = Builder::bvh, .progress = {}});
    const float diagonal = length(extent(bvh.bounds()));
    for (std::size_t i = 0; i < scene.viewpoints.size(); ++i) {
      SCOPED_TRACE(std::string(generated.name) + ", viewpoint " + std::to_string(i));
      const Camera camera(scene.viewpoints[i], side, side);
      int hits = 0, close = 0;
      for (std::size_t y = 0; y < side; ++y) {
        for (std::size_t x = 0; x < side; ++x) {
          const auto hit =
              bvh.intersect(camera.ray_through(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
          hits += hit.has_value();
          close += hit && hit->t < 0.005f * diagonal;
        }
      }
      EXPECT_GT(hits, static_cast<int>(side * side) / 4);
      EXPECT_LT(close, static_cast<int>(side * side) / 10);  // nothing stands right before the camera
    }
  }
}

}  // namespace
}  // namespace workbench
