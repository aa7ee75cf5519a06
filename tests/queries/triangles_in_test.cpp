// `triangles_in` against every triangle one by one.
#include <limits>

#include <gtest/gtest.h>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;

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

TEST(TrianglesIn, QuestionsWithoutSenseHaveNoAnswers) {
  const Bvh bvh = build(workbench::make_sphere(2).mesh());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(bvh.triangles_in(Box3f{}).empty());
  EXPECT_TRUE(bvh.triangles_in({{nan, 0, 0}, {1, 1, 1}}).empty());
  EXPECT_TRUE(Bvh().triangles_in({{0, 0, 0}, {1, 1, 1}}).empty());
}

}  // namespace
}  // namespace kerf
