// Programs as users of ray tracing libraries write them, each in its smallest form: what they ask, in the
// shape in which they ask it, against brute force.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "math/vec3f.hpp"
#include "support/brute_force.hpp"
#include "support/random_scenes.hpp"
#include "support/vector_libraries.hpp"

namespace kerf {
namespace {

// A sphere of 2 n^2 triangles around the origin, wound outwards.
TriangleSoup sphere(std::uint32_t n, float radius) {
  TriangleSoup mesh;
  const float pi = 3.14159265f;
  for (std::uint32_t row = 0; row <= n; ++row) {
    for (std::uint32_t column = 0; column < n; ++column) {
      const float latitude = pi * static_cast<float>(row) / static_cast<float>(n);
      const float longitude = 2 * pi * static_cast<float>(column) / static_cast<float>(n);
      const float ring = row == 0 || row == n ? 0.0f : std::sin(latitude);  // a point at each pole
      mesh.vertices.push_back(
          radius * Vec3f{ring * std::cos(longitude), ring * std::sin(longitude), std::cos(latitude)});
    }
  }
  for (std::uint32_t row = 0; row < n; ++row) {
    for (std::uint32_t column = 0; column < n; ++column) {
      const std::uint32_t next = (column + 1) % n, a = row * n + column, b = row * n + next;
      for (const std::uint32_t i : {a, a + n, b + n, a, b + n, b}) mesh.triangles.push_back(i);
    }
  }
  return mesh;
}

// A scene of several meshes that is asked with six floats a ray, and answers with an array for each number.
TEST(Clients, ARaycastingSceneAnswersInColumns) {
  std::mt19937 random(1);
  const TriangleSoup first = random_soup(random, 60, 0.7f, 0.5f),
                     second = random_soup(random, 40, 0.5f, 0.1f);
  const std::array meshes{first.mesh(), second.mesh()};
  const Bvh scene = build(meshes);
  constexpr std::size_t count = 500;
  std::vector<float> rays(6 * count);
  for (float& x : rays) x = std::uniform_real_distribution<float>(-1, 1)(random);

  std::vector<float> t(count), uv(2 * count);
  std::vector<std::uint32_t> geometry(count), primitive(count), crossings(count);
  HitView hits;
  hits.count = count;
  hits.t = {t.data()};
  hits.u = {uv.data(), 2 * sizeof(float)};
  hits.v = {uv.data() + 1, 2 * sizeof(float)};
  hits.mesh = {geometry.data()};
  hits.primitive = {primitive.data()};
  const RayView view = RayView::six_floats(rays.data(), count);
  std::unique_ptr<bool[]> occluded(new bool[count]);
  scene.intersect(view, hits);
  scene.occluded(view, FlagView(occluded.get(), count));
  scene.count_hits(view, crossings);
  const Lists<Hit> all = scene.all_hits(view);

  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float* const ray = &rays[6 * i];
    const Ray single{.origin = {ray[0], ray[1], ray[2]}, .direction = {ray[3], ray[4], ray[5]}};
    Hit expected;
    for (std::uint32_t mesh = 0; mesh < 2; ++mesh) {
      if (auto hit = brute_force(meshes[mesh], single); hit && hit->t < expected.t) {
        expected = *hit;
        expected.mesh = mesh;
      }
    }
    ASSERT_EQ((Hit{t[i], uv[2 * i], uv[2 * i + 1], primitive[i], geometry[i]}), expected) << i;
    ASSERT_EQ(occluded[i], static_cast<bool>(expected));
    ASSERT_EQ(all[i].size(), crossings[i]);
    ASSERT_EQ(all[i].empty(), !expected);
    if (expected) {
      ++found;
      ASSERT_EQ(all[i].front(), expected);
      ASSERT_NEAR(length(scene.geometry(single, expected).normal), 1.0f, 1e-5f);
    }
  }
  EXPECT_GT(found, count / 5);
}

// Segments, beams and all crossings of a line, from vectors of another library where there is one.
TEST(Clients, AnIntersectorAsksForSegmentsBeamsAndAllCrossings) {
#ifdef KERF_WITH_EIGEN
  using Point = Eigen::Vector3f;
  Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> vertices(4, 3);
  Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor> faces(4, 3);
  vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  faces << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
#else
  using Point = std::array<float, 3>;
  const std::vector<Point> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::array<std::uint32_t, 3> > faces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
#endif
  const Bvh tetrahedron = build({.vertices = vertices, .triangles = faces});
  const auto segment = [&](const Point& from, const Point& to) {
    const Vec3f a{from[0], from[1], from[2]}, b{to[0], to[1], to[2]};
    return tetrahedron.intersect(Ray{.origin = a, .direction = b - a, .t_max = 1.0f});
  };
  // Its end on the surface counts, an end before it does not.
  EXPECT_TRUE(segment({0.25f, 0.25f, -1.0f}, {0.25f, 0.25f, 0.0f}));
  EXPECT_FALSE(segment({0.25f, 0.25f, -1.0f}, {0.25f, 0.25f, -0.001f}));
  EXPECT_FLOAT_EQ(segment({0.25f, 0.25f, -1.0f}, {0.25f, 0.25f, 1.0f})->t, 0.5f);

  std::vector<Hit> crossings;
  tetrahedron.all_hits(Ray{.origin = {0.25f, 0.25f, -1.0f}, .direction = {0, 0, 1}},
                       [&](const Hit& hit) { crossings.push_back(hit); });
  ASSERT_EQ(crossings.size(), 2u);
  EXPECT_EQ(crossings[0].primitive, 0u);
  EXPECT_EQ(crossings[1].primitive, 3u);
  EXPECT_FLOAT_EQ(crossings[1].t, 1.5f);

  // A beam is what libraries without watertight rays trace in place of a ray. Through an edge, one is enough.
  for (const float x : {0.1f, 0.25f, 0.7f})
    EXPECT_TRUE(tetrahedron.intersect(Ray{.origin = {x, -1.0f, -1.0f}, .direction = {0, 1, 1}})) << x;
}

// A baker asks, for each texel of an atlas, rays that begin on the surface. Without an offset of their
// origins they do not meet the triangle that they leave, nor its neighbours, on a surface that curves away.
TEST(Clients, ABakersRaysLeaveTheSurfaceThatTheyBeginOn) {
  std::mt19937 random(3);
  const TriangleSoup ball = sphere(24, 2.0f);
  const Bvh bvh = build(ball.mesh());
  std::size_t texels = 0;
  for (std::uint32_t triangle = 0; 3 * triangle < ball.triangles.size(); ++triangle) {
    const auto corners = bvh.triangle({triangle, 0});
    if (!corners) continue;  // at the poles, where two corners are one
    std::uniform_real_distribution<float> weight(0.05f, 0.45f);
    const float u = weight(random), v = weight(random);
    const Vec3f texel = (1 - u - v) * corners->v0 + u * corners->v1 + v * corners->v2;
    const Vec3f normal = cross(corners->v1 - corners->v0, corners->v2 - corners->v0);
    const Vec3f outwards = normal + length(normal) * 0.5f * random_point(random, 0.5f);
    const auto others = [&](const Hit& hit) { return hit.primitive != triangle; };
    EXPECT_FALSE(bvh.occluded(Ray{.origin = texel, .direction = outwards}, others)) << triangle;
    EXPECT_TRUE(bvh.occluded(Ray{.origin = texel, .direction = -1.0f * outwards}, others)) << triangle;
    ++texels;
  }
  EXPECT_GT(texels, 1000u);
}

// A lidar turns: rays of one origin, with a range from which it measures and one up to which it does.
TEST(Clients, ALidarMeasuresRangesFromOneOrigin) {
  const TriangleSoup wall = sphere(48, 10.0f);
  const Bvh bvh = build(wall.mesh());
  const Vec3f sensor{1.0f, 2.0f, 0.5f};
  std::vector<Vec3f> directions;
  for (int ring = -8; ring <= 8; ++ring) {
    for (int step = 0; step < 360; ++step) {
      const float elevation = 0.05f * static_cast<float>(ring),
                  azimuth = 0.0174533f * static_cast<float>(step);
      directions.push_back({std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                            std::sin(elevation)});
    }
  }
  RayView rays = RayView::origins_and_directions(&sensor.x, &directions[0].x, directions.size(), 0);
  const float near = 0.5f, far = 100.0f, short_sighted = 5.0f;
  rays.t_min = {&near, 0};
  rays.t_max = {&far, 0};
  std::vector<float> ranges(directions.size());
  HitView hits;
  hits.count = ranges.size();
  hits.t = {ranges.data()};
  bvh.intersect(rays, hits);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float radius = length(sensor + ranges[i] * directions[i]);
    ASSERT_LE(radius, 10.0001f) << i;
    ASSERT_GE(radius, 9.9f) << i;  // the ball is made of flat triangles
  }
  rays.t_max = {&short_sighted, 0};
  bvh.intersect(rays, hits);
  for (const float range : ranges) ASSERT_TRUE(std::isinf(range));
}

// A renderer's shadow rays: leaves are cut out of triangles by a texture, and light passes what is cut out.
TEST(Clients, ARenderersShadowsPassWhatATextureCutsOut) {
  std::mt19937 random(5);
  const TriangleSoup leaves = random_soup(random, 80, 0.8f, 0.8f);
  const Bvh bvh = build(leaves.mesh());
  const auto opaque = [](const Hit& hit) { return std::fmod(8.0f * hit.u, 2.0f) < 1.0f; };
  std::size_t lit = 0, shadowed = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3f from = random_point(random, 1.5f);
    const Ray ray{.origin = from, .direction = random_point(random, 1.5f) - from, .t_max = 1.0f};
    bool expected = false;
    for (std::uint32_t k = 0; k < 80; ++k) {
      TriangleSoup one = leaves;
      one.triangles = {3 * k, 3 * k + 1, 3 * k + 2};
      const auto hit = brute_force(one.mesh(), ray, bvh.bounds());
      expected = expected || (hit && opaque(*hit));
    }
    ASSERT_EQ(bvh.occluded(ray, opaque), expected) << i;
    ++(expected ? shadowed : lit);
  }
  EXPECT_GT(std::min(lit, shadowed), 100u);
}

// What a library's own checks try first: rays that are none, scenes of nothing, surfaces on one another.
TEST(Clients, RaysThatAreNoneHitNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const TriangleSoup ball = sphere(8, 1.0f);
  const Bvh bvh = build(ball.mesh()), nothing = build(TriangleMesh{});
  const Ray good{.origin = {0.1f, 0.2f, -3.0f}, .direction = {0, 0, 1}};
  ASSERT_TRUE(bvh.occluded(good));
  std::vector<Ray> none(8, good);
  none[0].origin.x = nan;
  none[1].direction.z = nan;
  none[2].direction = {};
  none[3].t_max = 1.0f;
  none[4].t_min = 5.0f;
  none[5].t_min = 3.0f, none[5].t_max = 2.0f;
  none[6].direction.x = infinity;
  none[7].origin.z = infinity;
  for (std::size_t i = 0; i < none.size(); ++i) {
    EXPECT_FALSE(bvh.intersect(none[i])) << i;
    EXPECT_FALSE(bvh.occluded(none[i])) << i;
    EXPECT_EQ(bvh.count_hits(none[i]), 0u) << i;
  }
  EXPECT_FALSE(nothing.intersect(good));
  // Twice the same surface: the first of equals, and each of them among all.
  const std::array twice{ball.mesh(), ball.mesh()};
  const Bvh doubled = build(twice);
  EXPECT_EQ(doubled.intersect(good)->mesh, 0u);
  EXPECT_EQ(doubled.count_hits(good), 2 * bvh.count_hits(good));
}

}  // namespace
}  // namespace kerf
