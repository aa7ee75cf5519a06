#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "support/brute_force.hpp"
#include "support/random_scenes.hpp"

namespace {

using kerf::Ray;
using kerf::Vec3f;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

struct Variant {
  kerf::Builder builder;
  float alpha;
};
constexpr Variant variants[] = {{kerf::Builder::sbvh, 1e-5f}, {kerf::Builder::sbvh, 0.0f},
                                {kerf::Builder::sbvh, 1.0f},  {kerf::Builder::bvh, 1e-5f},
                                {kerf::Builder::esc, 1e-5f},  {kerf::Builder::evh, 1e-5f}};

std::vector<kerf::Bvh> build_all(const kerf::TriangleMesh& mesh) {
  std::vector<kerf::Bvh> all;
  for (const Variant& variant : variants) {
    all.push_back(
        kerf::build(mesh, {.builder = variant.builder, .alpha = variant.alpha, .max_reference_ratio = 4.0f}));
  }
  return all;
}

// Rays from `origin` toward random points on triangles, and toward their vertices and edge points.
std::vector<Ray> rays_at(const TriangleSoup& soup, std::mt19937& random, std::size_t count, float reach) {
  std::uniform_int_distribution<std::size_t> triangle(0, soup.triangles.size() / 3 - 1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = 3 * triangle(random);
    float u = uniform(random), v = uniform(random) * (1.0f - u);
    if (i % 4 == 1) u = v = 0.0f;  // a vertex
    if (i % 4 == 2) v = 0.0f;      // an edge
    const auto corner = [&](std::size_t k) { return soup.vertices[soup.triangles[first + k]]; };
    const Vec3f target = (1.0f - u - v) * corner(0) + u * corner(1) + v * corner(2);
    // every eighth ray starts in the plane of the triangle and meets it edge-on
    const Vec3f origin = i % 8 == 7 ? target + (corner(1) - corner(0)) * 3.0f : random_point(random, reach);
    rays.push_back({.origin = origin, .direction = target - origin});
  }
  return rays;
}

void expect_brute_force_hits(const TriangleSoup& soup, const std::vector<Ray>& rays) {
  const std::vector<kerf::Bvh> all = build_all(soup.mesh());
  for (const Ray& ray : rays) {
    const auto expected = brute_force(soup.mesh(), ray);
    for (const kerf::Bvh& bvh : all) {
      const auto hit = bvh.intersect(ray);
      ASSERT_EQ(hit.value_or(kerf::Hit{}), expected.value_or(kerf::Hit{}));
      ASSERT_EQ(bvh.occluded(ray), expected.has_value());
    }
  }
}

}  // namespace

TEST(Tracing, EveryTreeGivesTheHitsOfBruteForce) {
  std::mt19937 random(1);
  const TriangleSoup soup = random_soup(random, 400, 0.4f, 1.0f);
  expect_brute_force_hits(soup, rays_at(soup, random, 4000, 2.0f));
}

TEST(Tracing, SliversSeenUnderAnyAngleAreFoundInEveryTree) {
  std::mt19937 random(2);
  for (const float thinness : {1e-2f, 1e-4f, 1e-6f}) {
    const TriangleSoup soup = random_soup(random, 300, 1.0f, thinness);
    expect_brute_force_hits(soup, rays_at(soup, random, 2000, 2.0f));
  }
}

TEST(Tracing, CoincidentTrianglesAreHitAtTheLowestNumber) {
  std::mt19937 random(3);
  TriangleSoup soup = random_soup(random, 40, 0.8f, 1.0f);
  const std::vector<std::uint32_t> once = soup.triangles;
  for (int copy = 0; copy < 6; ++copy) soup.triangles.insert(soup.triangles.end(), once.begin(), once.end());
  expect_brute_force_hits(soup, rays_at(soup, random, 1500, 2.0f));
}

// Equal corners in equal order are told apart by numbers alone, others by what t is.
TEST(Tracing, HeapsOfTrianglesInAnyOrderOfCornersAreHitAtTheLowestNumber) {
  std::mt19937 random(11);
  TriangleSoup soup = random_soup(random, 5, 0.8f, 1.0f);
  soup.vertices[0].x = 0.0f;
  const std::vector<Vec3f> corners = soup.vertices;
  const std::vector<std::uint32_t> once = soup.triangles;
  const std::size_t count = once.size() / 3;
  // Another zero is another triangle for those who compare bits.
  const auto twin = static_cast<std::uint32_t>(soup.vertices.size());
  soup.vertices.push_back({-0.0f, corners[0].y, corners[0].z});
  soup.triangles.clear();
  for (int copy = 0; copy < 300; ++copy) {
    std::array<std::uint32_t, 3> triangle;
    std::copy_n(once.begin() + static_cast<std::ptrdiff_t>(3 * (random() % count)), 3, triangle.begin());
    for (auto turns = random() % 3; turns > 0; --turns)
      std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
    if (random() % 4 == 0) std::swap(triangle[0], triangle[1]);
    for (std::uint32_t& corner : triangle) {
      if (corner == 0 && random() % 2 == 0) corner = twin;
    }
    soup.triangles.insert(soup.triangles.end(), triangle.begin(), triangle.end());
  }
  const std::vector<Ray> rays = rays_at(soup, random, 1024, 2.0f);
  expect_brute_force_hits(soup, rays);
  // Once more as a span of rays that keep together, which packets trace.
  const Vec3f target = (1.0f / 3.0f) * (corners[0] + corners[1] + corners[2]);
  std::vector<Ray> beam;
  for (int i = 0; i < 1024; ++i) {
    const Vec3f to = target + 0.02f * random_point(random, 1.0f);
    beam.push_back({.origin = {0.1f, 0.2f, 3.0f}, .direction = to - Vec3f{0.1f, 0.2f, 3.0f}});
  }
  std::vector<kerf::Hit> hits(beam.size());
  kerf::build(soup.mesh()).intersect(beam, hits);
  for (std::size_t i = 0; i < beam.size(); ++i)
    ASSERT_EQ(hits[i], brute_force(soup.mesh(), beam[i]).value_or(kerf::Hit{})) << i;
}

TEST(Tracing, HugeAndTinyScenesAreHitLikeAnyOther) {
  std::mt19937 random(4);
  const TriangleSoup unit = random_soup(random, 200, 0.4f, 1.0f);
  for (const float scale : {1e9f, 1e-9f, 1e18f, 1e-18f}) {
    const TriangleSoup soup = scaled(unit, scale);
    const std::vector<Ray> rays = rays_at(soup, random, 1000, 2.0f * scale);
    std::size_t hits = 0;
    for (const Ray& ray : rays) hits += brute_force(soup.mesh(), ray).has_value();
    EXPECT_GT(hits, rays.size() / 2);
    expect_brute_force_hits(soup, rays);
  }
}

TEST(Tracing, FarOriginsLoseNothing) {
  std::mt19937 random(5);
  const TriangleSoup soup = random_soup(random, 200, 0.4f, 1.0f);
  expect_brute_force_hits(soup, rays_at(soup, random, 1000, 1e5f));
}

TEST(Tracing, DirectionsAlongAxesAndInPlanesOfBoxesAreHit) {
  // A grid in the plane z = 0: all boxes are flat, and rays within the plane of a box side touch it.
  TriangleSoup soup;
  for (std::uint32_t y = 0; y <= 8; ++y) {
    for (std::uint32_t x = 0; x <= 8; ++x) {
      soup.vertices.push_back({static_cast<float>(x), static_cast<float>(y), 0.0f});
      if (x == 8 || y == 8) continue;
      const std::uint32_t corner = 9 * y + x;
      for (const std::uint32_t i : {0u, 1u, 10u, 0u, 10u, 9u}) soup.triangles.push_back(corner + i);
    }
  }
  std::vector<Ray> rays;
  for (const float zero : {0.0f, -0.0f, 1e-42f, -1e-42f}) {
    for (float x = 0.5f; x < 8.0f; x += 0.5f) {
      for (float y = 0.5f; y < 8.0f; y += 0.5f) {
        rays.push_back({.origin = {x, y, 3.0f}, .direction = {zero, zero, -2.0f}});
        rays.push_back({.origin = {x, y, -1e-3f}, .direction = {0.0f, -0.0f, 1e-41f}});
      }
    }
  }
  for (const Ray& ray : rays) ASSERT_TRUE(brute_force(soup.mesh(), ray).has_value());
  expect_brute_force_hits(soup, rays);
}

TEST(Tracing, RangesThatBeginAtOrBehindTheOriginAreSearchedAsTheyAre) {
  std::mt19937 random(8);
  const TriangleSoup soup = random_soup(random, 200, 0.8f, 1.0f);
  std::vector<Ray> rays = rays_at(soup, random, 400, 0.9f);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    constexpr float starts[] = {-0.0f, -1e-42f, -0.25f, -3.0f, -infinity};
    rays[i].t_min = starts[i % std::size(starts)];
    if (i % 3 == 0) rays[i].t_max = i % 2 == 0 ? -0.0f : -0.125f;  // all of it at the origin or behind
  }
  expect_brute_force_hits(soup, rays);
}

TEST(Tracing, ARangeOfZeroAloneHoldsZeroWhateverItsSigns) {
  const std::vector<std::array<float, 3>> vertices{{0, 0, 0}, {4, 0, 0}, {0, 4, 0},
                                                   {0, 0, 9}, {4, 0, 9}, {0, 4, 9}};
  const std::vector<std::uint32_t> triangles{0, 1, 2, 3, 4, 5};
  const kerf::Bvh bvh = kerf::build({.vertices = vertices, .triangles = triangles});
  for (const float t_min : {0.0f, -0.0f}) {
    for (const float t_max : {0.0f, -0.0f}) {
      SCOPED_TRACE(testing::Message() << t_min << " to " << t_max);
      const Ray ray{.origin = {1, 1, 0}, .direction = {0.25f, 0, 1}, .t_min = t_min, .t_max = t_max};
      EXPECT_TRUE(bvh.intersect(ray).has_value());
      EXPECT_TRUE(bvh.occluded(ray));
      EXPECT_TRUE(bvh.intersect(ray, [](const kerf::Hit&) { return true; }).has_value());
      EXPECT_EQ(bvh.all_hits(ray, {}), 1u);
      const std::vector<Ray> same(64, ray);
      std::vector<kerf::Hit> hits(same.size());
      std::vector<std::uint8_t> occluded(same.size());
      bvh.intersect(same, hits);
      bvh.occluded(same, occluded);
      EXPECT_EQ(std::count_if(hits.begin(), hits.end(),
                              [](const kerf::Hit& hit) { return static_cast<bool>(hit); }),
                64);
      EXPECT_EQ(std::count(occluded.begin(), occluded.end(), 1), 64);
    }
  }
}

TEST(Tracing, DirectionLengthScalesTAlone) {
  std::mt19937 random(6);
  const TriangleSoup soup = random_soup(random, 100, 0.8f, 1.0f);
  const kerf::Bvh bvh = kerf::build(soup.mesh());
  for (const Ray& ray : rays_at(soup, random, 500, 2.0f)) {
    const auto hit = bvh.intersect(ray);
    for (const float power : {0x1p-100f, 0x1p-20f, 0x1p60f}) {
      const auto longer = bvh.intersect({.origin = ray.origin, .direction = ray.direction * power});
      ASSERT_EQ(hit.has_value(), longer.has_value());
      if (!hit) continue;
      ASSERT_EQ(hit->primitive, longer->primitive);
      ASSERT_EQ(hit->t / power, longer->t);
    }
  }
}

TEST(Tracing, OnlyHitsBetweenTMinAndTMaxCount) {
  const std::vector<std::array<float, 3>> vertices{{0, 0, 1}, {1, 0, 1}, {0, 1, 1},
                                                   {0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
  const std::vector<std::uint32_t> triangles{0, 1, 2, 3, 4, 5};
  const kerf::Bvh bvh = kerf::build({.vertices = vertices, .triangles = triangles});
  const auto t_of = [&](float t_min, float t_max) {
    const Ray ray{.origin = {0.25f, 0.25f, 0}, .direction = {0, 0, 1}, .t_min = t_min, .t_max = t_max};
    const auto hit = bvh.intersect(ray);
    EXPECT_EQ(bvh.occluded(ray), hit.has_value());
    return hit ? hit->t : -1.0f;
  };
  EXPECT_EQ(t_of(0, infinity), 1.0f);
  EXPECT_EQ(t_of(1, 1), 1.0f);  // both ends are included
  EXPECT_EQ(t_of(std::nextafter(1.0f, 2.0f), infinity), 2.0f);
  EXPECT_EQ(t_of(0, std::nextafter(1.0f, 0.0f)), -1.0f);
  EXPECT_EQ(t_of(1.5f, 2), 2.0f);
  EXPECT_EQ(t_of(2.5f, infinity), -1.0f);
  EXPECT_EQ(t_of(2, 1), -1.0f);
  EXPECT_EQ(t_of(-5, infinity), 1.0f);
}

// From the side, from between, in a direction that is scaled, and as a line without ends.
TEST(Tracing, ARayMayBeginBehindItsOrigin) {
  const std::vector<std::array<float, 3>> vertices{{0, 0, 1}, {1, 0, 1}, {0, 1, 1},
                                                   {0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
  const std::vector<std::uint32_t> triangles{0, 1, 2, 3, 4, 5};
  const kerf::Bvh bvh = kerf::build({.vertices = vertices, .triangles = triangles});
  for (const float length : {1.0f, 0x1p-40f, 0x1p40f}) {
    const auto t_of = [&](float from, float t_min, float t_max) {
      const Ray ray{.origin = {0.25f, 0.25f, from},
                    .direction = {0, 0, length},
                    .t_min = t_min / length,
                    .t_max = t_max / length};
      const auto hit = bvh.intersect(ray);
      EXPECT_EQ(bvh.occluded(ray), hit.has_value());
      EXPECT_EQ(bvh.count_hits(ray) != 0, hit.has_value());
      return hit ? hit->t * length : 99.0f;
    };
    EXPECT_EQ(t_of(3, -9, infinity), -2.0f) << "the least t, not the nearest to 0";
    EXPECT_EQ(t_of(3, -1.5f, infinity), -1.0f);
    EXPECT_EQ(t_of(3, -2, -2), -2.0f);
    EXPECT_EQ(t_of(3, -0.5f, infinity), 99.0f);
    EXPECT_EQ(t_of(3, -9, -3), 99.0f);
    EXPECT_EQ(t_of(1.5f, -0.25f, infinity), 0.5f);
    EXPECT_EQ(t_of(3, -infinity, infinity), -2.0f);
    EXPECT_EQ(t_of(0, -infinity, infinity), 1.0f);
  }
}

TEST(Tracing, AHitIsWrittenWhereTheCallerKeepsIt) {
  std::mt19937 random(8);
  const TriangleSoup soup = random_soup(random, 100, 1.0f, 1.0f);
  const kerf::Bvh bvh = kerf::build(soup.mesh()), empty;
  for (int i = 0; i < 200; ++i) {
    const Ray ray{.origin = random_point(random), .direction = random_point(random)};
    const kerf::Hit old{.t = 1.0f, .u = 0.5f, .v = 0.25f, .primitive = 7, .mesh = 3};
    kerf::Hit hit = old;
    const auto expected = bvh.intersect(ray);
    EXPECT_EQ(bvh.intersect(ray, hit), expected.has_value());
    EXPECT_EQ(hit, expected.value_or(kerf::Hit{}));
    hit = old;
    EXPECT_FALSE(empty.intersect(ray, hit));
    EXPECT_EQ(hit, kerf::Hit{});
  }
}

TEST(Tracing, RaysThatAreNoRaysHitNothing) {
  std::mt19937 random(7);
  const TriangleSoup soup = random_soup(random, 100, 2.0f, 1.0f);
  const kerf::Bvh bvh = kerf::build(soup.mesh());
  for (const float bad : {not_a_number, infinity, -infinity}) {
    for (int component = 0; component < 6; ++component) {
      Ray ray{.origin = {0, 0, 0}, .direction = {1, 1, 1}};
      (component < 3 ? ray.origin : ray.direction)[component % 3] = bad;
      EXPECT_FALSE(bvh.intersect(ray).has_value());
      EXPECT_FALSE(bvh.occluded(ray));
    }
  }
  for (const Ray& ray : {Ray{.origin = {}, .direction = {0, 0, 0}},
                         Ray{.origin = {}, .direction = {1, 1, 1}, .t_min = not_a_number},
                         Ray{.origin = {}, .direction = {1, 1, 1}, .t_max = not_a_number},
                         Ray{.origin = {}, .direction = {1, 1, 1}, .t_min = infinity}}) {
    EXPECT_FALSE(bvh.intersect(ray).has_value());
    EXPECT_FALSE(bvh.occluded(ray));
  }
}

TEST(Tracing, AnEmptyHierarchyIsMissed) {
  const kerf::Bvh empty;
  const Ray ray{.origin = {}, .direction = {1, 0, 0}};
  EXPECT_FALSE(empty.intersect(ray).has_value());
  EXPECT_FALSE(empty.occluded(ray));
  EXPECT_TRUE(empty.bounds().empty());
}

TEST(Tracing, SpansGiveTheHitsOfSingleRays) {
  std::mt19937 random(8);
  const TriangleSoup soup = random_soup(random, 300, 0.5f, 1.0f);
  const kerf::Bvh bvh = kerf::build(soup.mesh());
  std::vector<Ray> rays = rays_at(soup, random, 3001, 2.0f);
  rays[17].direction = {};
  rays[18].origin.x = not_a_number;
  std::vector<kerf::Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  bvh.intersect(rays, hits);
  bvh.occluded(rays, occluded);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(hits[i], bvh.intersect(rays[i]).value_or(kerf::Hit{}));
    ASSERT_EQ(occluded[i] != 0, bvh.occluded(rays[i]));
  }
  EXPECT_THROW(bvh.intersect(rays, std::span(hits).first(1)), kerf::Error);
  EXPECT_THROW(bvh.occluded(rays, std::span(occluded).first(1)), kerf::Error);
}
