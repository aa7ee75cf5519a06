#include <array>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

TEST(Bvh, HitsTheOneTriangleThereIs) {
  const std::vector<std::array<float, 3>> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::uint32_t> triangles{0, 1, 2};
  const kerf::Bvh bvh = kerf::build({.vertices = vertices, .triangles = triangles});
  const auto hit = bvh.intersect({.origin = {0.25f, 0.5f, 1.0f}, .direction = {0, 0, -2}});
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(*hit, (kerf::Hit{.t = 0.5f, .u = 0.25f, .v = 0.5f, .primitive = 0, .mesh = 0}));
}

TEST(Bvh, WhatWasMovedFromIsAHierarchyOfNothing) {
  const std::vector<std::array<float, 3>> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::uint32_t> triangles{0, 1, 2};
  const kerf::Ray ray{.origin = {0.25f, 0.5f, 1.0f}, .direction = {0, 0, -2}};
  kerf::Bvh from = kerf::build({.vertices = vertices, .triangles = triangles});
  kerf::Bvh to = std::move(from);
  EXPECT_TRUE(to.intersect(ray).has_value());
  EXPECT_FALSE(from.intersect(ray).has_value());
  EXPECT_EQ(from.statistics().triangles, 0u);
  from = std::move(to);
  EXPECT_TRUE(from.intersect(ray).has_value());
  EXPECT_FALSE(to.occluded(ray));
  EXPECT_TRUE(to.bounds().empty());
}
