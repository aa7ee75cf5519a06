// `closest_point`, `within` and `triangles_in`, against every triangle one by one.
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "queries/triangle_box.hpp"
#include "structure.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"
#include "support/targets.hpp"
#include "traversal/dispatch.hpp"
#include "workbench/generate/solids.hpp"

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

// A hierarchy for the kernels of each instruction set.
std::vector<Bvh> build_for_each_target(const TriangleMesh& mesh) {
  std::vector<Bvh> hierarchies;
  kerf_tests::for_each_target(
      [&](const Target&) { hierarchies.push_back(build(mesh, spatial_splits_everywhere())); });
  return hierarchies;
}

// The point of the world at `origin` that is `scale` times as large.
struct World {
  Vec3f origin;
  float scale;

  Vec3f operator()(const Vec3f& p) const { return origin + scale * p; }
  Soup operator()(const Soup& soup) const {
    std::vector<Triangle> moved;
    for (const auto& [a, b, c] : soup.triangles) {
      const Triangle triangle{(*this)(a), (*this)(b), (*this)(c)};
      if (!is_degenerate(triangle)) moved.push_back(triangle);
    }
    return Soup(std::move(moved));
  }
};

// Asks for the triangle closest to points next to corners and up to `distance` sizes of the world away.
void expect_closest(std::mt19937& random, const Soup& sizeless, const World& world, float distance) {
  const Soup soup = world(sizeless);
  const std::vector<Bvh> hierarchies = build_for_each_target(soup.mesh());
  for (int i = 0; i < 10; ++i) {
    const Vec3f at_corner = sizeless.triangles[random() % sizeless.triangles.size()].v1;
    const Vec3f p = world(i % 2 ? uniform_point(random, distance) : at_corner + uniform_point(random, 1e-6f));
    std::vector<exact::Number> squares;
    for (const Triangle& triangle : soup.triangles) squares.push_back(exact::squared_distance(p, triangle));
    const auto root = [](const exact::Number& square) { return std::sqrt(square.convert_to<double>()); };
    const double least = root(*std::min_element(squares.begin(), squares.end()));
    const auto found = hierarchies.front().closest_point(p);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->distance, least, 1e-7 * least + 1e-15 * world.scale + 0x1p-149);
    EXPECT_NEAR(root(squares[found->primitive]), least, 1e-14 * least + 1e-15 * world.scale);
    const Vec3d way = difference(found->position, p);
    EXPECT_NEAR(std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z), found->distance,
                1e-5 * (double{world.scale} + length(world.origin) + found->distance));
    // The limit is included, and nothing lies below it.
    EXPECT_TRUE(hierarchies.front().closest_point(p, std::nextafter(found->distance, 1e38f)).has_value());
    EXPECT_FALSE(hierarchies.front().closest_point(p, std::nextafter(found->distance, 0.0f)).has_value());
    for (const Bvh& bvh : hierarchies)
      ASSERT_EQ(bvh.closest_point(p), found) << bvh.structure().kernels->target;
  }
}

TEST(ClosestPoint, IsTheClosestOfAllTrianglesInExactArithmeticForEveryInstructionSet) {
  std::mt19937 random(2);
  for (const float thinness : {1.0f, 1e-3f, 1e-8f}) {
    const Soup soup = sliver_soup(random, thinness);
    for (const float distance : {1.0f, 100.0f}) expect_closest(random, soup, {{0, 0, 0}, 1.0f}, distance);
  }
}

TEST(ClosestPoint, KeepsItsAccuracyInTinyHugeAndRemoteWorldsAndFromFarAway) {
  std::mt19937 random(3);
  const Soup soup = sliver_soup(random, 0.3f);
  for (const float scale : {1e-38f, 1e-30f, 1e-6f, 1e6f, 1e30f, 4e37f}) {
    expect_closest(random, soup, {{0, 0, 0}, scale}, 2.0f);
  }
  for (const float away : {1e2f, 1e4f}) expect_closest(random, soup, {{away, -away, 0}, 1.0f}, 2.0f);
  for (const float distance : {1e3f, 1e5f, 1e7f, 1e12f, 1e30f})
    expect_closest(random, soup, {{0, 0, 0}, 1.0f}, distance);
}

TEST(Within, GivesEachTriangleInReachOnceNearestFirst) {
  std::mt19937 random(3);
  const Soup soup = sliver_soup(random, 0.1f);
  const std::vector<Bvh> hierarchies = build_for_each_target(soup.mesh());
  for (int i = 0; i < 300; ++i) {
    const Vec3f p = uniform_point(random, 1.0f);
    const float radius = uniform(random, 0.0f, 1.5f);
    std::set<std::uint32_t> expected;
    for (std::uint32_t id = 0; id < soup.triangles.size(); ++id) {
      if (exact::squared_distance(p, soup.triangles[id]) <= exact::number(radius) * exact::number(radius))
        expected.insert(id);
    }
    const std::vector<SurfacePoint> found = hierarchies.front().within(p, radius);
    for (const Bvh& bvh : hierarchies) ASSERT_EQ(bvh.within(p, radius), found);
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
