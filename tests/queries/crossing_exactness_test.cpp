// What `all_hits` finds, against rational arithmetic.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "math/line_crossing.hpp"
#include "math/ray_box.hpp"
#include "math/ray_crossing.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"

namespace kerf {
namespace {

using namespace adversarial;
using exact::Meeting;

// What `all_hits` promises: a triangle is crossed in its interior, and not outside; on its boundary it may
// be.
void expect_exact(const Soup& soup, const Ray& ray, const std::vector<Hit>& hits) {
  std::map<std::uint32_t, Hit> found;
  for (const Hit& hit : hits) ASSERT_TRUE(found.emplace(hit.primitive, hit).second) << "reported twice";
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    const exact::Crossing truth = exact::cross_line(ray.origin, ray.direction, soup.triangles[i]);
    const bool in_range = truth.meeting != Meeting::none && truth.t >= exact::number(ray.t_min) &&
                          (!std::isfinite(ray.t_max) || truth.t <= exact::number(ray.t_max));
    const auto hit = found.find(i);
    if (truth.meeting == Meeting::interior && in_range) {
      ASSERT_NE(hit, found.end()) << "missed triangle " << i;
    }
    if (!in_range) {
      ASSERT_EQ(hit, found.end()) << "reported triangle " << i;
    }
    if (hit == found.end()) continue;
    EXPECT_NEAR(hit->second.t, truth.t.convert_to<double>(), 1.5e-7 * std::abs(truth.t.convert_to<double>()));
    EXPECT_NEAR(hit->second.u, truth.u.convert_to<double>(), 1e-6);
    EXPECT_NEAR(hit->second.v, truth.v.convert_to<double>(), 1e-6);
  }
}

std::vector<Hit> gather(const Bvh& bvh, const Ray& ray) {
  std::vector<Hit> hits;
  bvh.all_hits(ray, [&](const Hit& hit) { hits.push_back(hit); });
  EXPECT_TRUE(std::is_sorted(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    return a.t != b.t ? a.t < b.t : a.primitive < b.primitive;
  }));
  EXPECT_EQ(bvh.count_hits(ray), hits.size());
  std::vector<Hit> listed(hits.size() + 1);
  EXPECT_EQ(bvh.all_hits(ray, listed), hits.size());
  EXPECT_TRUE(std::equal(hits.begin(), hits.end(), listed.begin()));
  // However early the visitor stops, it has seen the first hits.
  for (std::size_t count = 1; count < hits.size(); ++count) {
    std::vector<Hit> first;
    bvh.all_hits(ray, [&](const Hit& hit) {
      first.push_back(hit);
      return first.size() < count;
    });
    EXPECT_TRUE(first.size() == count && std::equal(first.begin(), first.end(), hits.begin()));
  }
  return hits;
}

TEST(CrossingExactness, IsExactOnAGridWhereEverythingIsAligned) {
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    const Soup triangles = soup(40, [&] { return grid_point(random, 3); });
    const Bvh bvh = build(triangles.mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 100; ++i) {
      Ray ray{.origin = grid_point(random, 4), .direction = grid_point(random, 3)};
      if (ray.direction == Vec3f{}) continue;
      if (i % 4 == 1) ray.t_max = 1.0f;
      if (i % 4 == 2) ray.t_min = i % 8 == 2 ? 0.5f : -1.0f;
      ASSERT_NO_FATAL_FAILURE(expect_exact(triangles, ray, gather(bvh, ray)));
    }
  }
}

TEST(CrossingExactness, IsExactAtAMillionthAndAMillionSizesDistance) {
  std::mt19937 random(2);
  for (const float distance : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f}) {
    const Soup triangles = soup(40, [&] { return uniform_point(random, 1.0f); });
    const Bvh bvh = build(triangles.mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 200; ++i) {
      const Ray ray = aim(random, triangles.triangles[random() % 40], distance);
      if (ray.direction == Vec3f{}) continue;
      ASSERT_NO_FATAL_FAILURE(expect_exact(triangles, ray, gather(bvh, ray)));
    }
  }
}

TEST(CrossingExactness, IsExactFarFromTheOriginAndAtExtremeScales) {
  std::mt19937 random(3);
  struct Place {
    float offset, scale;
  };
  for (const auto& [at, size] :
       {Place{1e5f, 1.0f}, Place{1e7f, 4.0f}, Place{0.0f, 1e-30f}, Place{0.0f, 1e-42f}, Place{0.0f, 1e37f}}) {
    const float offset = at, scale = size;  // a lambda cannot capture parts of a structured binding
    const Soup triangles = soup(40, [&] {
      return Vec3f{offset, -offset, offset} + uniform_point(random, scale);
    });
    const Bvh bvh = build(triangles.mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 200; ++i) {
      const Ray ray = aim(random, triangles.triangles[random() % 40], 1.0f);
      if (ray.direction == Vec3f{} || !is_finite(ray.direction) || !is_finite(ray.origin)) continue;
      ASSERT_NO_FATAL_FAILURE(expect_exact(triangles, ray, gather(bvh, ray)));
    }
  }
}

TEST(CrossingExactness, IsExactOnSliversOfAspectAHundredMillion) {
  std::mt19937 random(4);
  std::vector<Triangle> slivers;
  while (slivers.size() < 60) {
    const Vec3f a = uniform_point(random, 1.0f), b = uniform_point(random, 1.0f);
    const Vec3f c = a + uniform(random, 0.0f, 1.0f) * (b - a) + uniform_point(random, 1e-8f);
    if (!collinear(a, b, c)) slivers.push_back({a, b, c});
  }
  const Soup triangles(slivers);
  const Bvh bvh = build(triangles.mesh(), spatial_splits_everywhere());
  for (int i = 0; i < 600; ++i) {
    const Ray ray = aim(random, triangles.triangles[random() % 60], 1.0f);
    ASSERT_NO_FATAL_FAILURE(expect_exact(triangles, ray, gather(bvh, ray)));
  }
}

// Rays that end or begin exactly at a triangle, with coordinates that use all bits of a float.
TEST(CrossingExactness, IsExactAtBothEndsOfTheRange) {
  std::mt19937 random(6);
  for (int round = 0; round < 1000; ++round) {
    const Vec3f a = grid_point(random, 1 << 19), d1 = grid_point(random, 1 << 19),
                d2 = grid_point(random, 1 << 19);
    if (collinear({}, d1, d2)) continue;
    const Soup one({{a, a + 4.0f * d1, a + 4.0f * d2}});
    const Bvh bvh = build(one.mesh());
    const Vec3f at = a + d1 + d2, origin = grid_point(random, 1 << 19);
    Ray ray{.origin = origin, .direction = at - origin, .t_min = 0.0f, .t_max = 1.0f};
    ASSERT_NO_FATAL_FAILURE(expect_exact(one, ray, gather(bvh, ray)));
    ray.t_max = std::nextafter(1.0f, 0.0f);
    ASSERT_NO_FATAL_FAILURE(expect_exact(one, ray, gather(bvh, ray)));
    ray.t_min = 1.0f, ray.t_max = 2.0f;
    ASSERT_NO_FATAL_FAILURE(expect_exact(one, ray, gather(bvh, ray)));
    ray.t_min = std::nextafter(1.0f, 2.0f);
    ASSERT_NO_FATAL_FAILURE(expect_exact(one, ray, gather(bvh, ray)));
  }
}

// The order of `all_hits` relies on this: otherwise a crossing would be found after later ones have been
// visited. Rounding changes t most for grazing rays.
TEST(CrossingExactness, NoCrossingSeemsToComeBeforeItsBox) {
  std::mt19937 random(7);
  int crossings = 0;
  for (int i = 0; i < 300000; ++i) {
    const auto power = [&](float low, float high) { return std::pow(10.0f, uniform(random, low, high)); };
    const float offset = power(0, 4), size = power(-4, 1);
    const Vec3f a = Vec3f{offset, offset, offset} + uniform_point(random, 1.0f);
    const Triangle triangle{a, a + uniform_point(random, size), a + uniform_point(random, size)};
    const Vec3f e1 = triangle.v1 - a, e2 = triangle.v2 - a;
    const float s = power(-8, 0), r = power(-8, 0);
    const Vec3f at = a + s * (1.0f - r) * e1 + s * r * e2;
    const Vec3f along = uniform(random, -1, 1) * e1 + uniform(random, -1, 1) * e2 +
                        uniform_point(random, size * power(-9, -1));
    const Vec3f origin = at - power(-1, 6) * along;
    const Vec3f direction = at - origin;
    if (!line_crosses(origin, direction, triangle)) continue;
    const float t_crossing = crossing_of(origin, direction, triangle).t;
    if (t_crossing < 0.0f) continue;
    ++crossings;
    const Box3f box = bounds_of(triangle);
    const RayBoxes boxes(origin, direction, box);
    ASSERT_LE(boxes.entry(box, 0.0f, std::numeric_limits<float>::infinity()), t_crossing);
  }
  EXPECT_GT(crossings, 20000);
}

// The half-open rule: two triangles on both sides of an edge, seen from the same side, own each point of the
// edge once. All triangles of a fan own their common vertex once.
TEST(CrossingExactness, AFanOwnsItsHubOnce) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    const Vec3f hub = grid_point(random, 2);
    const Vec3f rim[] = {
        hub + Vec3f{3, 0, grid_point(random, 2).z}, hub + Vec3f{0, 3, grid_point(random, 2).z},
        hub + Vec3f{-3, 0, grid_point(random, 2).z}, hub + Vec3f{0, -3, grid_point(random, 2).z}};
    const Vec3f direction{0, 0, -1};
    for (const Vec3f at : {hub, 0.5f * (hub + rim[round % 4])}) {
      int crossed = 0;
      for (int i = 0; i < 4; ++i) {
        crossed += line_crosses(at + Vec3f{0, 0, 9}, direction, {hub, rim[i], rim[(i + 1) % 4]});
      }
      EXPECT_EQ(crossed, 1);
    }
  }
}

}  // namespace
}  // namespace kerf
