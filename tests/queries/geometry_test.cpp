// What is at a hit, against the meshes that were built from.
#include <cmath>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "math/predicates.hpp"
#include "math/vec3f.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;
using workbench::Solid;

Triangle triangle_of(const Solid& solid, std::uint32_t i) {
  const auto& [a, b, c] = solid.triangles[i];
  return {solid.vertices[a], solid.vertices[b], solid.vertices[c]};
}

TEST(Geometry, EachTriangleComesBackByItsName) {
  const Solid torus = workbench::make_torus(24, 12), sphere = workbench::make_sphere(2);
  const TriangleMesh meshes[] = {torus.mesh(), sphere.mesh()};
  const TemporaryDirectory directory;
  build(meshes, spatial_splits_everywhere()).save(directory / "scene.kerf");
  for (const Bvh& bvh : {build(meshes, spatial_splits_everywhere()), Bvh::map(directory / "scene.kerf")}) {
    std::uint32_t mesh = 0;
    for (const Solid* solid : {&torus, &sphere}) {
      for (std::uint32_t i = 0; i < solid->triangles.size(); ++i)
        ASSERT_EQ(bvh.triangle({i, mesh}), triangle_of(*solid, i));
      EXPECT_FALSE(bvh.triangle({static_cast<std::uint32_t>(solid->triangles.size()), mesh}).has_value());
      ++mesh;
    }
    EXPECT_FALSE(bvh.triangle({0, 2}).has_value());
    EXPECT_FALSE(bvh.triangle({}).has_value());
  }
  EXPECT_FALSE(Bvh().triangle({0, 0}).has_value());
}

TEST(Geometry, ATriangleWithoutAreaIsInNoLeaf) {
  const Soup soup({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
  const Bvh bvh = build(soup.mesh());
  EXPECT_FALSE(bvh.triangle({0, 0}).has_value());
  EXPECT_EQ(bvh.triangle({1, 0}), soup.triangles[1]);
}

// Normals and sides, for triangles of all shapes and sizes.
TEST(Geometry, NormalAndSideAreThoseOfRationalArithmetic) {
  std::mt19937 random(1);
  for (const float scale : {1.0f, 1e-30f, 1e-42f, 1e37f}) {
    for (int i = 0; i < 200; ++i) {
      const Vec3f a = uniform_point(random, scale), b = a + uniform_point(random, scale);
      const Vec3f c =
          a + uniform(random, -1, 1) * (b - a) + uniform_point(random, i % 2 ? scale : 1e-6f * scale);
      if (collinear(a, b, c)) continue;
      const Soup one({{a, b, c}});
      const Bvh bvh = build(one.mesh());
      // Any hit is one of the triangle; the ray need not be the one that found it.
      const Ray ray{.origin = {}, .direction = i % 3 == 0 ? b - a : uniform_point(random, 1.0f)};
      if (ray.direction == Vec3f{}) continue;
      const HitGeometry found = bvh.geometry(ray, {.t = 1, .primitive = 0, .mesh = 0});
      EXPECT_EQ(found.triangle, one.triangles[0]);

      using exact::vector;
      const exact::Vector normal = exact::cross(vector(b) - vector(a), vector(c) - vector(a));
      EXPECT_EQ(found.front, exact::dot(normal, vector(ray.direction)) <= 0);
      // Scaled, so that doubles hold them.
      const auto largest = std::max({abs(normal.x), abs(normal.y), abs(normal.z)});
      const double n[3] = {exact::Number(normal.x / largest).convert_to<double>(),
                           exact::Number(normal.y / largest).convert_to<double>(),
                           exact::Number(normal.z / largest).convert_to<double>()};
      const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(found.normal[axis], n[axis] / length, 1.2e-7);
    }
  }
}

TEST(Geometry, ASphereIsHitFromInsideOnItsBack) {
  const Bvh bvh = build(workbench::make_sphere(3).mesh());
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const Ray out{.origin = {}, .direction = uniform_point(random, 1.0f)};
    const Ray in{.origin = 9.0f * normalize(out.direction), .direction = -1.0f * out.direction};
    const HitGeometry back = bvh.geometry(out, *bvh.intersect(out)),
                      front = bvh.geometry(in, *bvh.intersect(in));
    EXPECT_FALSE(back.front);
    EXPECT_TRUE(front.front);
    EXPECT_GT(dot(back.normal, out.direction), 0.0f);
  }
}

TEST(Geometry, AHitOfNoTriangleIsRefused) {
  const Bvh bvh = build(workbench::make_sphere(1).mesh());
  for (const Hit& hit : {Hit{}, Hit{.primitive = 80, .mesh = 0}, Hit{.primitive = 0, .mesh = 1}})
    EXPECT_THROW((void)bvh.geometry({.origin = {}, .direction = {1, 0, 0}}, hit), Error);
}

TEST(Geometry, ManyThreadsMayAskFirst) {
  const Solid sphere = workbench::make_sphere(4);
  const Bvh bvh = build(sphere.mesh());
  std::vector<std::jthread> threads;
  for (int k = 0; k < 4; ++k) {
    threads.emplace_back([&] {
      for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(bvh.triangle({i, 0}), triangle_of(sphere, i));
    });
  }
}

TEST(Geometry, StatisticsByMeshAddUpToThoseOfAll) {
  const Solid torus = workbench::make_torus(24, 12), box = workbench::make_box({2, 2, 2}, {3, 3, 3}, 3);
  const Soup flat({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{5, 5, 5}, {6, 5, 5}, {5, 6, 5}}});
  const TriangleMesh meshes[] = {torus.mesh(), {}, box.mesh(), flat.mesh()};
  const Bvh bvh = build(meshes, spatial_splits_everywhere());
  const std::vector<MeshStatistics> all = bvh.mesh_statistics();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].triangles, 576u);
  EXPECT_EQ(all[1].triangles, 0u);
  EXPECT_EQ(all[2].triangles, 108u);
  EXPECT_EQ(all[2].bounds, (Box3f{{2, 2, 2}, {3, 3, 3}}));
  EXPECT_TRUE(all[1].bounds.empty());
  EXPECT_EQ(all[3].left_out, 1u);
  EXPECT_EQ(all[3].bounds, (Box3f{{5, 5, 5}, {6, 6, 5}}));
  std::size_t references = 0, left_out = 0;
  for (const MeshStatistics& mesh : all) references += mesh.references, left_out += mesh.left_out;
  EXPECT_EQ(references, bvh.statistics().references);
  EXPECT_EQ(left_out, bvh.statistics().degenerate_triangles);
  EXPECT_TRUE(Bvh().mesh_statistics().empty());
}

}  // namespace
}  // namespace kerf
