// `within` against every triangle one by one.
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "support/adversarial.hpp"
#include "support/exact_oracle.hpp"
#include "support/proximity.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;

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

TEST(Within, QuestionsWithoutSenseHaveNoAnswers) {
  const Bvh bvh = build(workbench::make_sphere(2).mesh());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(bvh.within({0, 0, 0}, -1.0f).empty());
  EXPECT_TRUE(bvh.within({nan, 0, 0}, 1.0f).empty());
  EXPECT_TRUE(Bvh().within({0, 0, 0}, 1.0f).empty());
}

}  // namespace
}  // namespace kerf
