// `nearest` against every triangle one by one.
#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/adversarial.hpp"
#include "support/exact_oracle.hpp"
#include "support/proximity.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;

const float infinity = std::numeric_limits<float>::infinity();

TEST(Nearest, GivesTheNearestTrianglesEachOnceOnEveryInstructionSet) {
  std::mt19937 random(3);
  const Soup soup = sliver_soup(random, 0.1f);
  const std::vector<Bvh> hierarchies = build_for_each_target(soup.mesh());
  for (int i = 0; i < 100; ++i) {
    const Vec3f p = uniform_point(random, i % 4 == 0 ? 100.0f : 1.0f);
    std::vector<std::pair<exact::Number, std::uint32_t>> all;
    for (std::uint32_t id = 0; id < soup.triangles.size(); ++id)
      all.emplace_back(exact::squared_distance(p, soup.triangles[id]), id);
    std::sort(all.begin(), all.end());
    for (const std::size_t count : {std::size_t{1}, std::size_t{5}, std::size_t{59}, std::size_t{1000}}) {
      const std::vector<SurfacePoint> found = hierarchies.front().nearest(p, count);
      ASSERT_EQ(found.size(), std::min(count, all.size()));
      for (std::size_t k = 0; k < found.size(); ++k) {
        // Distances that are equal in double precision may stand in another order.
        EXPECT_NEAR(found[k].distance, std::sqrt(all[k].first.convert_to<double>()),
                    1e-6 * found[k].distance);
        for (std::size_t j = 0; j < k; ++j) ASSERT_NE(found[j].primitive, found[k].primitive);
      }
      for (const Bvh& bvh : hierarchies) ASSERT_EQ(bvh.nearest(p, count), found);
    }
  }
}

TEST(Nearest, OfTrianglesAtTheSameDistanceTheLowestNumbersComeFirst) {
  const Soup copies(std::vector<Triangle>(500, Triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}));
  const std::vector<SurfacePoint> found = build(copies.mesh()).nearest({1, 1, 2}, 100);
  ASSERT_EQ(found.size(), 100u);
  for (std::uint32_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].primitive, i);
    EXPECT_EQ(found[i].distance, 2.0f);
  }
}

TEST(Nearest, OneIsTheClosestPointAndAllAreThoseWithin) {
  const Bvh bvh = build(workbench::make_torus(24, 12).mesh(), spatial_splits_everywhere());
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    const Vec3f p = uniform_point(random, 2.0f);
    const float radius = uniform(random, 0.0f, 1.0f);
    const auto closest = bvh.closest_point(p, radius);
    const std::vector<SurfacePoint> one = bvh.nearest(p, 1, radius);
    ASSERT_EQ(one.size(), closest ? 1u : 0u);
    ASSERT_TRUE(!closest || one.front() == *closest);
    ASSERT_EQ(bvh.nearest(p, 1u << 20, radius), bvh.within(p, radius));
  }
}

TEST(Nearest, QuestionsWithoutSenseHaveNoAnswers) {
  const Bvh bvh = build(workbench::make_sphere(2).mesh());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(bvh.nearest({0, 0, 0}, 0).empty());
  EXPECT_TRUE(bvh.nearest({0, 0, 0}, 3, -1.0f).empty());
  EXPECT_TRUE(bvh.nearest({nan, 0, 0}, 3).empty());
  EXPECT_TRUE(bvh.nearest({infinity, 0, 0}, 3).empty());
  EXPECT_TRUE(Bvh().nearest({0, 0, 0}, 3).empty());
}

}  // namespace
}  // namespace kerf
