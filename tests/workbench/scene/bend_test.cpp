#include "workbench/scene/bend.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace workbench {
namespace {

TEST(Bend, MovesVerticesAcrossTheLongestAxisByUpToAPartOfTheExtent) {
  std::vector<kerf::Vec3f> rest;
  for (int i = 0; i <= 100; ++i) rest.push_back({0.5f, 0.1f * static_cast<float>(i) - 3.0f, 2.0f});
  std::vector<kerf::Vec3f> bent(rest.size());
  bend(rest, 0.05, 0.3, bent);
  double farthest = 0.0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    EXPECT_EQ(bent[i].y, rest[i].y) << "along the axis nothing moves";
    farthest = std::max(farthest, std::abs(static_cast<double>(bent[i].z) - rest[i].z));
    EXPECT_LE(std::abs(bent[i].x - rest[i].x), 0.251f);
  }
  EXPECT_NEAR(farthest, 0.5, 0.01) << "a twentieth of ten";
}

TEST(Bend, ComesAroundAndKeepsTheEnds) {
  const std::vector<kerf::Vec3f> rest{{0, 0, 0}, {1, 0, 0}, {4, 0, 0}};
  std::vector<kerf::Vec3f> once(3), again(3);
  bend(rest, 0.1, 0.5, once);
  bend(rest, 0.1, 0.5 + 2.0 * std::numbers::pi, again);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(once[i].y, again[i].y, 1e-6f);
  EXPECT_NEAR(once[0].y, once[2].y, 1e-6f) << "one wave fits into the extent";
}

TEST(Bend, LeavesASinglePointWhereItIs) {
  const std::vector<kerf::Vec3f> rest{{1, 2, 3}, {1, 2, 3}};
  std::vector<kerf::Vec3f> bent(2);
  bend(rest, 0.5, 1.0, bent);
  EXPECT_EQ(bent, rest);
}

}  // namespace
}  // namespace workbench
