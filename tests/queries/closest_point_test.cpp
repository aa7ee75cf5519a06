// `closest_point` against every triangle one by one.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>

#include "structure.hpp"
#include "support/adversarial.hpp"
#include "support/exact_oracle.hpp"
#include "support/proximity.hpp"
#include "traversal/dispatch.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;

// Places a scene: scaled by `scale`, then moved to `origin`.
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

// Asks for the triangle closest to points near corners, and to points up to `distance` times the size of the
// scene away.
void expect_closest(std::mt19937& random, const Soup& sizeless, const World& world, float distance) {
  const Soup soup = world(sizeless);
  const std::vector<Bvh> hierarchies = build_for_each_target(soup.mesh());
  for (int i = 0; i < 10; ++i) {
    const Vec3f at_corner = sizeless.triangles[random() % sizeless.triangles.size()].v1;
    const Vec3f p = world(i % 2 ? uniform_point(random, distance) : at_corner + uniform_point(random, 1e-6f));
    std::vector<exact::Number> squares;
    for (const Triangle& triangle : soup.triangles) squares.push_back(exact::squared_distance(p, triangle));
    const auto root = [](const exact::Number& square) { return std::sqrt(square.convert_to<double>()); };
    const double expected = root(*std::min_element(squares.begin(), squares.end()));
    const auto found = hierarchies.front().closest_point(p);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->distance, expected, 1e-7 * expected + 1e-15 * world.scale + 0x1p-149);
    EXPECT_NEAR(root(squares[found->primitive]), expected, 1e-14 * expected + 1e-15 * world.scale);
    const Vec3d way = difference(found->position, p);
    EXPECT_NEAR(std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z), found->distance,
                1e-5 * (double{world.scale} + length(world.origin) + found->distance));
    // The limit is included, and nothing lies below it.
    EXPECT_TRUE(hierarchies.front().closest_point(p, std::nextafter(found->distance, 1e38f)).has_value());
    EXPECT_FALSE(hierarchies.front().closest_point(p, std::nextafter(found->distance, 0.0f)).has_value());
    for (const Bvh& bvh : hierarchies) ASSERT_EQ(bvh.closest_point(p), found) << instruction_set(bvh);
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

TEST(ClosestPoint, QuestionsWithoutSenseHaveNoAnswer) {
  const Bvh bvh = build(workbench::make_sphere(2).mesh());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(bvh.closest_point({nan, 0, 0}).has_value());
  EXPECT_FALSE(bvh.closest_point({0, 0, 0}, nan).has_value());
  EXPECT_FALSE(bvh.closest_point({0, 0, 0}, -1.0f).has_value());
  EXPECT_FALSE(Bvh().closest_point({0, 0, 0}).has_value());
}

}  // namespace
}  // namespace kerf
