#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "math/vec3f.hpp"
#include "support/instrumented.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/rays/aimed_rays.hpp"

namespace {

using kerf::Ray;
using kerf::Vec3f;

// Rays from `origin` at every vertex and at three points of every edge.
std::vector<Ray> aimed_rays(const workbench::Solid& solid, const Vec3f& origin) {
  std::vector<Ray> rays;
  const auto aim = [&](const Vec3f& target) {
    rays.push_back({.origin = origin, .direction = target - origin});
  };
  for (const Vec3f& vertex : solid.vertices) aim(vertex);
  for (const auto& triangle : solid.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = triangle[static_cast<std::size_t>(k)];
      const std::uint32_t j = triangle[static_cast<std::size_t>((k + 1) % 3)];
      if (i > j) continue;  // the neighbour has this edge the other way round
      for (const float s : {0.25f, 0.5f, 0.8f}) aim((1.0f - s) * solid.vertices[i] + s * solid.vertices[j]);
    }
  }
  return rays;
}

std::size_t count_leaks(const kerf::Bvh& bvh, const std::vector<Ray>& rays) {
  std::size_t leaks = 0;
  for (std::size_t i = 0; i < rays.size(); i += test::slowdown) {
    const Ray& ray = rays[i];
    leaks += !bvh.intersect(ray).has_value() || !bvh.occluded(ray);
  }
  std::vector<kerf::Hit> hits(rays.size());
  bvh.intersect(rays, hits);
  for (const kerf::Hit& hit : hits) leaks += !hit;
  return leaks;
}

// `solid` rotated about an oblique axis, scaled by `size`, and moved.
workbench::Solid moved(workbench::Solid solid, float size, const Vec3f& offset) {
  const float c = std::cos(0.7f), s = std::sin(0.7f);
  for (Vec3f& v : solid.vertices) {
    v = {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    v = {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
    v = v * size + offset;
  }
  return solid;
}

const kerf::BuildOptions split_everywhere{.alpha = 0.0f, .max_reference_ratio = 2.0f};

}  // namespace

TEST(Watertight, NothingLeavesASphereOf81920Triangles) {
  const workbench::Solid sphere = workbench::make_sphere(6);
  ASSERT_EQ(sphere.triangles.size(), 81920u);
  const kerf::Bvh bvh = kerf::build(sphere.mesh(), split_everywhere);
  for (const Vec3f origin : {Vec3f{0, 0, 0}, Vec3f{0.3f, -0.2f, 0.45f}}) {
    EXPECT_EQ(count_leaks(bvh, aimed_rays(sphere, origin)), 0u);
  }
}

TEST(Watertight, NothingLeavesTheSphereTurnedScaledAndMoved) {
  const workbench::Solid unit = workbench::make_sphere(5);
  struct Placement {
    float size;
    Vec3f offset;
  };
  for (const auto& [size, offset] :
       {Placement{1.0f, {0, 0, 0}}, Placement{1e3f, {-200, 3000, 70}}, Placement{1.0f, {1e4f, -3e4f, 2e4f}},
        Placement{1e-9f, {1e-9f, 0, 2e-9f}}, Placement{1e9f, {0, 3e9f, 0}}}) {
    const workbench::Solid sphere = moved(unit, size, offset);
    const kerf::Bvh bvh = kerf::build(sphere.mesh(), split_everywhere);
    const Vec3f inside = offset + Vec3f{0.3f, -0.2f, 0.45f} * size;
    EXPECT_EQ(count_leaks(bvh, aimed_rays(sphere, offset)), 0u);
    EXPECT_EQ(count_leaks(bvh, aimed_rays(sphere, inside)), 0u);
  }
}

TEST(Watertight, NothingLeavesABoxAlongItsWalls) {
  const workbench::Solid box = workbench::make_box({-1, -2, -3}, {1, 2, 3}, 16);
  const kerf::Bvh bvh = kerf::build(box.mesh(), split_everywhere);
  for (const Vec3f origin : {Vec3f{0, 0, 0}, Vec3f{0.99f, 1.99f, -2.99f}, Vec3f{-0.5f, 0.25f, 1.5f}}) {
    EXPECT_EQ(count_leaks(bvh, aimed_rays(box, origin)), 0u);
  }
}

TEST(Watertight, NothingLeavesATorusTube) {
  const workbench::Solid torus = workbench::make_torus(96, 48);
  const kerf::Bvh bvh = kerf::build(torus.mesh(), split_everywhere);
  const std::vector<Ray> rays = aimed_rays(torus, {1.0f, 0.0f, 0.0f});
  EXPECT_EQ(count_leaks(bvh, rays), 0u);
}

// A hundredth of bench/watertight_run.cpp.
TEST(Watertight, AMillionAimedRaysNeitherLeakNorMiscount) {
  const std::vector<workbench::NamedSolid> solids = workbench::make_watertight_solids();
  for (const auto& [name, solid] : solids) {
    const kerf::Bvh bvh = kerf::build(solid.mesh(), split_everywhere);
    const workbench::AimedRayCounts counts =
        workbench::trace_aimed_rays(solid, bvh, test::reduced(1'000'000) / solids.size() + 1, 64);
    EXPECT_EQ(counts.leaks, 0u) << name;
    EXPECT_EQ(counts.parity_errors, 0u) << name;
  }
}
