// Where a ray crosses a triangle, against rational arithmetic: to the float nearest to t or its neighbour,
// for every size of the triangle and every distance from it.
#include "math/ray_crossing.hpp"

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "support/adversarial.hpp"
#include "support/exact_oracle.hpp"
#include "support/targets.hpp"

namespace kerf {
namespace {

using namespace adversarial;
using exact::Number;

TEST(RayCrossing, TIsTheExactOneRoundedForEverySizeAndDistance) {
  std::mt19937 random(1);
  int crossings = 0;
  double max_error = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const float size = power_of_ten(random, -6, 6),
                offset = i % 2 ? 0.0f : size * power_of_ten(random, -2, 2);
    const Vec3f at{offset, -offset, offset};
    const Triangle triangle{at + uniform_point(random, size), at + uniform_point(random, size),
                            at + uniform_point(random, size)};
    if (is_degenerate(triangle)) continue;
    const Ray ray = ray_from_beside(random, triangle, size * power_of_ten(random, -9, 2));
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || ray.direction == Vec3f{}) continue;
    const exact::Crossing truth = exact::cross_line(ray.origin, ray.direction, triangle);
    if (truth.meeting == exact::Meeting::none) continue;
    ++crossings;
    const RayCrossing crossing = crossing_of(ray.origin, ray.direction, triangle);
    const double error = exact::error_in_ulps(crossing.t, truth.t);
    max_error = std::max(max_error, error);
    ASSERT_LE(error, 1.0) << crossing.t << " for " << truth.t.convert_to<double>();
    ASSERT_EQ(crossing.t < 0.0f, truth.t < 0);
    ASSERT_NEAR(crossing.u, truth.u.convert_to<double>(), 1e-6);
    ASSERT_NEAR(crossing.v, truth.v.convert_to<double>(), 1e-6);
  }
  EXPECT_GT(crossings, 100000);
  EXPECT_LT(max_error, 0.6);  // half of a unit, but for the rare case that the double lay on the other side
}

TEST(RayCrossing, TIsZeroForARayThatBeginsInThePlane) {
  std::mt19937 random(2);
  for (int i = 0; i < 20000; ++i) {
    const Vec3f a = grid_point(random, 1000), e = grid_point(random, 1000), f = grid_point(random, 1000);
    const Triangle triangle{a, a + 4.0f * e, a + 4.0f * f};
    if (is_degenerate(triangle)) continue;
    const Vec3f origin = a + e + f;  // exact, and inside
    const Vec3f direction = uniform_point(random, 1.0f);
    if (exact::cross_line(origin, direction, triangle).meeting == exact::Meeting::none) continue;
    const RayCrossing crossing = crossing_of(origin, direction, triangle);
    ASSERT_EQ(crossing.t, 0.0f);
    ASSERT_FLOAT_EQ(crossing.u, 0.25f);
    ASSERT_FLOAT_EQ(crossing.v, 0.25f);
  }
}

struct Floor {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> triangles{0, 1, 2, 0, 2, 3};

  explicit Floor(float half, float z = 0.0f)
      : vertices{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}} {}
  TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

TEST(RayCrossing, AFloorIsHitFromAboveAtItsDistanceAndNeverByRaysThatGoUp) {
  kerf_tests::for_each_target([](const Target&) {
    std::mt19937 random(3);
    for (const float half : {1.0f, 1e3f, 1e4f, 1e6f}) {
      const Bvh bvh = build(Floor(half).mesh());
      for (const float height : {1.7f, 1e-3f, 1e-5f}) {
        for (int i = 0; i < 2000; ++i) {
          const Vec3f origin{uniform(random, -0.7f, 0.7f) * half, uniform(random, -0.7f, 0.7f) * half,
                             height};
          const Vec3f aside{uniform(random, -0.1f, 0.1f), uniform(random, -0.1f, 0.1f), 0.0f};
          ASSERT_FALSE(bvh.intersect({.origin = origin, .direction = aside + Vec3f{0, 0, 1}}));
          const auto hit = bvh.intersect({.origin = origin, .direction = aside + Vec3f{0, 0, -1}});
          ASSERT_TRUE(hit);
          ASSERT_EQ(hit->t, height);
        }
      }
    }
  });
}

TEST(RayCrossing, ARugJustAboveAFloorComesFirst) {
  kerf_tests::for_each_target([](const Target&) {
    std::mt19937 random(4);
    const Floor floor(1e3f), rug(0.5f, 1e-5f);
    const TriangleMesh meshes[] = {floor.mesh(), rug.mesh()};
    const Bvh bvh = build(meshes);
    std::vector<Ray> rays(5000);
    for (Ray& ray : rays) {
      const Vec3f to{uniform(random, -0.49f, 0.49f), uniform(random, -0.49f, 0.49f), 1e-5f};
      ray.origin = to + Vec3f{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, 0.5f, 2.0f)};
      ray.direction = to - ray.origin;
    }
    std::vector<Hit> hits(rays.size());
    bvh.intersect(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(hits[i].mesh, 1u);
      ASSERT_EQ(bvh.intersect(rays[i]), hits[i]);
    }
  });
}

// One ray and one triangle have one t, u and v, whatever call asks.
TEST(RayCrossing, EveryCallGivesTheSameNumbers) {
  kerf_tests::for_each_target([](const Target&) {
    std::mt19937 random(5);
    for (const float distance : {1e-3f, 1.0f, 1e3f}) {
      const Soup triangles = soup(60, [&] { return uniform_point(random, 1.0f); });
      const Bvh bvh = build(triangles.mesh());
      int compared = 0;
      for (int i = 0; i < 1000; ++i) {
        const Ray ray = aim(random, triangles.triangles[random() % 60], distance);
        if (ray.direction == Vec3f{}) continue;
        const auto closest = bvh.intersect(ray);
        Hit span{};
        bvh.intersect(std::span<const Ray>(&ray, 1), std::span<Hit>(&span, 1));
        ASSERT_EQ(span, closest.value_or(Hit{}));
        std::optional<Hit> same;
        bvh.all_hits(ray, [&](const Hit& hit) {
          if (closest && hit.primitive == closest->primitive) same = hit;
        });
        if (!same) continue;  // hit within the shear's rounding, and not crossed; or nothing is hit
        ++compared;
        ASSERT_EQ(*same, *closest);
        Ray up_to = ray;
        up_to.t_max = closest->t;
        bool found = false;
        bvh.all_hits(up_to, [&](const Hit& hit) { found |= hit == *closest; });
        ASSERT_TRUE(found);
        ASSERT_EQ(bvh.intersect(up_to), closest);
        ASSERT_TRUE(bvh.occluded(up_to));
      }
      EXPECT_GT(compared, 300);
    }
  });
}

}  // namespace
}  // namespace kerf
