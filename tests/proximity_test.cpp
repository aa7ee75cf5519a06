// `closest_point`, `within` and `triangles_in`, against every triangle one by one.
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "adversarial.hpp"
#include "build_options.hpp"
#include "exact_oracle.hpp"
#include "query/point_distance.hpp"
#include "query/triangle_box.hpp"
#include "workbench/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;

Soup sliver_soup(std::mt19937& random, float thinness) {
  std::vector<Triangle> slivers;
  while (slivers.size() < 60) {
    const Vec3f a = uniform_point(random, 1.0f), b = uniform_point(random, 1.0f);
    const Vec3f c = a + uniform(random, 0.0f, 1.0f) * (b - a) + uniform_point(random, thinness);
    if (!collinear(a, b, c)) slivers.push_back({a, b, c});
  }
  return Soup(std::move(slivers));
}

TEST(ClosestOnTriangle, AgreesWithExactArithmeticAlsoOnSlivers) {
  std::mt19937 random(1);
  for (const float thinness : {1.0f, 1e-3f, 1e-8f}) {
    const Soup soup = sliver_soup(random, thinness);
    for (const Triangle& triangle : soup.triangles) {
      for (int i = 0; i < 20; ++i) {
        const Vec3f p = i % 2 ? uniform_point(random, 2.0f) : triangle.v0 + uniform_point(random, 1e-6f);
        const double truth = std::sqrt(exact::squared_distance(p, triangle).convert_to<double>());
        const ClosestOnTriangle found = closest_on_triangle(p, triangle);
        ASSERT_NEAR(std::sqrt(found.squared_distance), truth, 1e-7 * truth + 1e-15);
      }
    }
  }
}

TEST(ClosestPoint, IsTheClosestOfAllTriangles) {
  std::mt19937 random(2);
  for (const float thinness : {1.0f, 0.01f, 1e-8f}) {
    const Soup soup = sliver_soup(random, thinness);
    const Bvh bvh = build(soup.mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 300; ++i) {
      const Vec3f p = uniform_point(random, i % 3 ? 1.0f : 100.0f);
      double best = std::numeric_limits<double>::infinity();
      std::uint32_t best_id = invalid_id;
      for (std::uint32_t id = 0; id < soup.triangles.size(); ++id) {
        const double d = closest_on_triangle(p, soup.triangles[id]).squared_distance;
        if (d < best) best = d, best_id = id;
      }
      const auto found = bvh.closest_point(p);
      ASSERT_TRUE(found.has_value());
      EXPECT_EQ(found->primitive, best_id);
      EXPECT_EQ(found->mesh, 0u);
      EXPECT_EQ(found->distance, static_cast<float>(std::sqrt(best)));
      EXPECT_NEAR(length(found->position - p), found->distance, 1e-5f * (1.0f + found->distance));
      // The limit is included, and nothing lies below it.
      EXPECT_TRUE(bvh.closest_point(p, std::nextafter(found->distance, 1e30f)).has_value());
      EXPECT_FALSE(bvh.closest_point(p, std::nextafter(found->distance, 0.0f)).has_value());
    }
  }
}

TEST(Within, GivesEachTriangleInReachOnceNearestFirst) {
  std::mt19937 random(3);
  const Soup soup = sliver_soup(random, 0.1f);
  const Bvh bvh = build(soup.mesh(), spatial_splits_everywhere());
  for (int i = 0; i < 300; ++i) {
    const Vec3f p = uniform_point(random, 1.0f);
    const float radius = uniform(random, 0.0f, 1.5f);
    std::set<std::uint32_t> expected;
    for (std::uint32_t id = 0; id < soup.triangles.size(); ++id) {
      if (exact::squared_distance(p, soup.triangles[id]) <= exact::number(radius) * exact::number(radius))
        expected.insert(id);
    }
    const std::vector<SurfacePoint> found = bvh.within(p, radius);
    std::set<std::uint32_t> ids;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_TRUE(ids.insert(found[k].primitive).second);
      EXPECT_TRUE(k == 0 || found[k - 1].distance <= found[k].distance);
    }
    ASSERT_EQ(ids, expected);
  }
}

TEST(TrianglesIn, AgreesWithExactClipping) {
  std::mt19937 random(4);
  for (int round = 0; round < 20; ++round) {
    const bool grid = round % 2 == 0;
    const auto point = [&] { return grid ? grid_point(random, 3) : uniform_point(random, 3.0f); };
    const Soup triangles = soup(30, point);
    const Bvh bvh = build(triangles.mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 30; ++i) {
      const Vec3f a = point(), b = point();
      const Box3f box{min(a, b), max(a, b)};  // flat ones too
      std::vector<PrimitiveId> expected;
      for (std::uint32_t id = 0; id < triangles.triangles.size(); ++id) {
        if (exact::overlaps(triangles.triangles[id], box)) expected.push_back({id, 0});
      }
      ASSERT_EQ(bvh.triangles_in(box), expected);
    }
  }
}

TEST(TrianglesIn, ABoxThatTouchesOneVertexFindsItsTriangles) {
  const workbench::Solid solid = workbench::make_box({0, 0, 0}, {2, 2, 2});
  const Bvh bvh = build(solid.mesh());
  std::size_t at_corner = 0;
  for (const auto& triangle : solid.triangles) {
    for (const std::uint32_t v : triangle) at_corner += solid.vertices[v] == Vec3f{2, 2, 2};
  }
  EXPECT_EQ(bvh.triangles_in({{2, 2, 2}, {3, 3, 3}}).size(), at_corner);
  EXPECT_TRUE(bvh.triangles_in({{2.0000002f, 2, 2}, {3, 3, 3}}).empty());
}

TEST(TrianglesIn, ABoxWithoutEndsFindsEveryTriangleOnce) {
  const Bvh bvh = build(workbench::make_sphere(3).mesh(), spatial_splits_everywhere());
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(bvh.triangles_in({{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}).size(),
            1280u);
}

TEST(Proximity, QuestionsWithoutSenseHaveNoAnswers) {
  const Bvh bvh = build(workbench::make_sphere(2).mesh());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(bvh.closest_point({nan, 0, 0}).has_value());
  EXPECT_FALSE(bvh.closest_point({0, 0, 0}, nan).has_value());
  EXPECT_FALSE(bvh.closest_point({0, 0, 0}, -1.0f).has_value());
  EXPECT_TRUE(bvh.within({0, 0, 0}, -1.0f).empty());
  EXPECT_TRUE(bvh.within({nan, 0, 0}, 1.0f).empty());
  EXPECT_TRUE(bvh.triangles_in(Box3f{}).empty());
  EXPECT_TRUE(bvh.triangles_in({{nan, 0, 0}, {1, 1, 1}}).empty());
  EXPECT_FALSE(Bvh().closest_point({0, 0, 0}).has_value());
  EXPECT_TRUE(Bvh().within({0, 0, 0}, 1.0f).empty());
  EXPECT_TRUE(Bvh().triangles_in({{0, 0, 0}, {1, 1, 1}}).empty());
}

}  // namespace
}  // namespace kerf
