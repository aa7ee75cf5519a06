// Coordinates near the ends of the range of floats, and t below its smallest normal number.
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "support/adversarial.hpp"
#include "support/brute_force.hpp"
#include "support/targets.hpp"

namespace kerf {
namespace {

using namespace adversarial;

// Single and span calls: the rays of a span are alike, so that packets take them where there are packets.
void expect_hits_of(const Bvh& bvh, const Soup& triangles, const Ray& ray, std::size_t& hits) {
  const auto expected = brute_force(triangles.mesh(), ray);
  hits += expected.has_value();
  EXPECT_EQ(bvh.intersect(ray), expected);
  EXPECT_EQ(bvh.occluded(ray), expected.has_value());
  const std::vector<Ray> rays(32, ray);
  std::vector<Hit> found(rays.size());
  bvh.intersect(rays, found);
  EXPECT_EQ(found[17], expected.value_or(Hit{}));
}

TEST(ExtremeScales, NoHitIsLostAtVastCoordinates) {
  std::mt19937 random(1);
  kerf_tests::for_each_target([&](const Target&) {
    for (const int exponent : {60, 88, 91, 94, 102, 110, 124}) {
      const float scale = std::ldexp(1.0f, exponent);
      const Soup triangles = soup(40, [&] { return uniform_point(random, scale); });
      const Bvh bvh = build(triangles.mesh());
      std::size_t hits = 0;
      for (int i = 0; i < 60; ++i) {
        // Along an axis, in a plane of two, or any way, through a point of a triangle.
        const Triangle& target = triangles.triangles[random() % 40];
        const Vec3f at = 0.5f * target.v0 + (0.25f * target.v1 + 0.25f * target.v2);
        Vec3f direction = uniform_point(random, std::ldexp(1.0f, static_cast<int>(random() % 30) - 8));
        if (i % 3 != 0) direction[i % 2] = 0.0f;
        if (i % 3 == 2) direction[2] = 0.0f;
        if (direction == Vec3f{}) continue;
        const float away =
            0.3f * scale / std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
        expect_hits_of(bvh, triangles, {.origin = at - away * direction, .direction = direction}, hits);
      }
      EXPECT_GT(hits, 50u) << exponent;
    }
  });
}

TEST(ExtremeScales, AVastSceneFarFromTheOriginOfSmallExtent) {
  std::mt19937 random(2);
  const float far = 0x1p100f, step = 0x1p80f;
  const Soup triangles = soup(20, [&] {
    const Vec3f p = grid_point(random, 4);
    return Vec3f{far + step * p.x, step * p.y, far - step * p.z};
  });
  kerf_tests::for_each_target([&](const Target&) {
    const Bvh bvh = build(triangles.mesh());
    std::size_t hits = 0;
    for (int i = 0; i < 60; ++i) {
      const Triangle& target = triangles.triangles[random() % 20];
      const Vec3f at = target.v0 + (0.375f * (target.v1 - target.v0) + 0.25f * (target.v2 - target.v0));
      const Ray ray{.origin = {at.x, at.y, far - 64 * step}, .direction = {0, 0, 0.00390626f}};
      expect_hits_of(bvh, triangles, ray, hits);
    }
    EXPECT_GT(hits, 20u);
  });
}

TEST(ExtremeScales, AHitBelowTheSmallestNormalNumberIsFoundAgain) {
  std::mt19937 random(3);
  const Soup triangles = soup(40, [&] { return uniform_point(random, 1.0f); });
  kerf_tests::for_each_target([&](const Target&) {
    const Bvh bvh = build(triangles.mesh());
    std::size_t subnormal = 0;
    for (int i = 0; i < 200; ++i) {
      const Triangle& target = triangles.triangles[random() % 40];
      const Vec3f origin = uniform_point(random, 2.0f),
                  way = target.v0 + target.v1 + target.v2 - 3.0f * origin;
      const float length = std::ldexp(1.0f, 120 + i % 7);
      const float nearness = std::ldexp(1.0f, -(i % 24));
      Ray ray{.origin = target.v0 - nearness * way, .direction = length * way};
      if (!std::isfinite(ray.direction.x + ray.direction.y + ray.direction.z)) continue;
      const auto hit = bvh.intersect(ray);
      if (!hit || hit->t == 0.0f) continue;
      subnormal += hit->t < std::numeric_limits<float>::min();
      const float less = std::nextafter(hit->t, 0.0f);
      const float more = std::nextafter(hit->t, 1.0f);
      ray.t_max = hit->t;
      EXPECT_EQ(bvh.intersect(ray), hit);
      EXPECT_TRUE(bvh.occluded(ray));
      ray.t_min = hit->t;
      EXPECT_EQ(bvh.intersect(ray), hit);
      EXPECT_TRUE(bvh.occluded(ray));
      ray.t_max = std::numeric_limits<float>::infinity();
      EXPECT_EQ(bvh.intersect(ray), hit);
      ray.t_min = 0.0f;
      ray.t_max = less;
      EXPECT_EQ(bvh.intersect(ray), std::nullopt);
      EXPECT_FALSE(bvh.occluded(ray));
      ray.t_min = more;
      ray.t_max = std::numeric_limits<float>::infinity();
      const auto next = bvh.intersect(ray);
      EXPECT_TRUE(!next || next->t >= more);

      const float behind = -hit->t;
      Ray reversed{
          .origin = ray.origin, .direction = -1.0f * ray.direction, .t_min = behind, .t_max = behind};
      const auto mirrored = bvh.intersect(reversed);
      ASSERT_TRUE(mirrored);
      EXPECT_EQ(mirrored->t, behind);
      reversed.t_min = -std::numeric_limits<float>::infinity();
      reversed.t_max = -more;
      const auto farther = bvh.intersect(reversed);
      EXPECT_TRUE(!farther || farther->t <= -more);
    }
    EXPECT_GT(subnormal, 20u);
  });
}

}  // namespace
}  // namespace kerf
