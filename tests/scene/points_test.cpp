// Distances in scenes against every triangle of every instance.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "support/adversarial.hpp"
#include "support/instrumented.hpp"
#include "support/random_triangles.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using adversarial::uniform;
using adversarial::uniform_point;

using Point = std::array<long double, 3>;

Point moved(const Transform& m, const Vec3f& p) {
  Point to;
  for (std::size_t i = 0; i < 3; ++i) {
    to[i] = m.rows[i][3];
    for (std::size_t j = 0; j < 3; ++j)
      to[i] += static_cast<long double>(m.rows[i][j]) * p[static_cast<int>(j)];
  }
  return to;
}

long double distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// By the region of the triangle's plane that the point lies over (Ericson 2005, "Real-Time Collision
// Detection", 5.1.5), in long doubles.
long double distance_to_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
  const auto from = [](const Point& x, const Point& y) {
    return Point{y[0] - x[0], y[1] - x[1], y[2] - x[2]};
  };
  const auto dot = [](const Point& x, const Point& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; };
  const Point ab = from(a, b), ac = from(a, c);
  const auto at = [&](long double u, long double v) {
    Point q;
    for (std::size_t i = 0; i < 3; ++i) q[i] = a[i] + u * ab[i] + v * ac[i];
    return distance(p, q);
  };
  const long double d1 = dot(ab, from(a, p)), d2 = dot(ac, from(a, p)), d3 = dot(ab, from(b, p)),
                    d4 = dot(ac, from(b, p)), d5 = dot(ab, from(c, p)), d6 = dot(ac, from(c, p));
  if (d1 <= 0 && d2 <= 0) return at(0, 0);
  if (d3 >= 0 && d4 <= d3) return at(1, 0);
  if (d6 >= 0 && d5 <= d6) return at(0, 1);
  const long double of_c = d1 * d4 - d3 * d2, of_b = d5 * d2 - d1 * d6, of_a = d3 * d6 - d5 * d4;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return at(d1 / (d1 - d3), 0);
  if (of_b <= 0 && d2 >= 0 && d6 <= 0) return at(0, d2 / (d2 - d6));
  if (of_a <= 0 && d4 >= d3 && d5 >= d6) {
    const long double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return at(1 - w, w);
  }
  return at(of_b / (of_a + of_b + of_c), of_c / (of_a + of_b + of_c));
}

struct World {
  std::vector<kerf_tests::Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<std::size_t> mesh_of;

  // Objects under maps that turn, scale by other factors along other axes, and shear.
  World(std::mt19937& random, std::size_t count) {
    for (std::uint32_t seed = 1; seed < 3; ++seed)
      meshes.push_back(kerf_tests::random_triangles(12, 0.5f, 0.3f, seed));
    const Bvh objects[] = {build(meshes[0].mesh()), build(meshes[1].mesh())};
    for (std::size_t i = 0; i < count; ++i) {
      Transform m;
      for (auto& row : m.rows) {
        for (double& x : row) x = uniform(random, -1, 1);
        row[3] *= 4;
      }
      if (i % 4 == 0) m = {{{2, 0, 0, m.rows[0][3]}, {0, 0, 2, 1}, {0, -2, 0, 3}}};
      instances.push_back({.object = objects[i % 2], .transform = m});
      mesh_of.push_back(i % 2);
    }
  }

  long double distance_to(const Vec3f& point, std::uint32_t instance, std::uint32_t primitive) const {
    const kerf_tests::Mesh& mesh = meshes[mesh_of[instance]];
    const auto& [a, b, c] = mesh.triangles[primitive];
    const Transform& m = instances[instance].transform;
    return distance_to_triangle(moved({}, point), moved(m, mesh.vertices[a]), moved(m, mesh.vertices[b]),
                                moved(m, mesh.vertices[c]));
  }
};

TEST(ScenePoints, TheClosestIsThatOfEveryTriangleUnderScaleAndShear) {
  std::mt19937 random(1);
  const World world(random, 40);
  const Scene scene = build(world.instances);
  for (std::size_t i = 0; i < test::reduced(100); ++i) {
    const Vec3f point = uniform_point(random, 5.0f);
    long double least = std::numeric_limits<long double>::infinity();
    for (std::uint32_t instance = 0; instance < world.instances.size(); ++instance) {
      for (std::uint32_t primitive = 0; primitive < 12; ++primitive)
        least = std::min(least, world.distance_to(point, instance, primitive));
    }
    const auto found = scene.closest_point(point);
    ASSERT_TRUE(found);
    ASSERT_NEAR(found->distance, static_cast<double>(least), 1e-6);
    ASSERT_NEAR(static_cast<double>(world.distance_to(point, found->instance, found->primitive)),
                static_cast<double>(least), 1e-6);
    const Vec3f off = found->position - point;
    ASSERT_NEAR(std::hypot(off.x, off.y, off.z), found->distance, 1e-5);
    ASSERT_FALSE(scene.closest_point(point, 0.999f * found->distance));
    ASSERT_TRUE(scene.closest_point(point, 1.001f * found->distance));
    ASSERT_EQ(std::abs(scene.signed_distance(point)), found->distance);
  }
}

TEST(ScenePoints, WithinARadiusIsEveryTriangleOnce) {
  std::mt19937 random(2);
  const World world(random, 30);
  const Scene scene = build(world.instances);
  for (std::size_t i = 0; i < test::reduced(40); ++i) {
    const Vec3f point = uniform_point(random, 4.0f);
    const float radius = uniform(random, 0.5f, 3.0f);
    const std::vector<ScenePoint> found = scene.within(point, radius);
    std::size_t expected = 0;
    for (std::uint32_t instance = 0; instance < world.instances.size(); ++instance) {
      for (std::uint32_t primitive = 0; primitive < 12; ++primitive) {
        const bool is_within = world.distance_to(point, instance, primitive) <= radius;
        expected += is_within;
        ASSERT_EQ(std::count_if(found.begin(), found.end(),
                                [&](const ScenePoint& p) {
                                  return p.instance == instance && p.primitive == primitive;
                                }),
                  is_within);
      }
    }
    ASSERT_EQ(found.size(), expected);
    ASSERT_TRUE(std::is_sorted(found.begin(), found.end(), [](const ScenePoint& a, const ScenePoint& b) {
      return a.distance < b.distance;
    }));
  }
}

TEST(ScenePoints, TheNearestAreTheFirstOfAllTriangles) {
  std::mt19937 random(11);
  const World world(random, 40);
  const Scene scene = build(world.instances);
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < test::reduced(60) + 2; ++i) points.push_back(uniform_point(random, 5.0f));
  for (const std::size_t count : {std::size_t{1}, std::size_t{5}, std::size_t{30}, std::size_t{1000}}) {
    const Lists<ScenePoint> many = scene.nearest(points, count);
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::vector<long double> distances;
      for (std::uint32_t instance = 0; instance < world.instances.size(); ++instance)
        for (std::uint32_t primitive = 0; primitive < 12; ++primitive)
          distances.push_back(world.distance_to(points[i], instance, primitive));
      std::sort(distances.begin(), distances.end());
      const std::vector<ScenePoint> found = scene.nearest(points[i], count);
      ASSERT_EQ(found.size(), std::min(count, distances.size()));
      for (std::size_t k = 0; k < found.size(); ++k) {
        const auto expected = static_cast<double>(distances[k]);
        EXPECT_NEAR(found[k].distance, expected, 1e-6 * (1 + expected));
        const auto own =
            static_cast<double>(world.distance_to(points[i], found[k].instance, found[k].primitive));
        EXPECT_NEAR(found[k].distance, own, 1e-6 * (1 + own));
      }
      std::vector<ScenePoint> all = scene.within(points[i], std::numeric_limits<float>::infinity());
      all.resize(found.size());
      EXPECT_EQ(found, all);
      EXPECT_TRUE(std::equal(found.begin(), found.end(), many[i].begin(), many[i].end()));
      if (found.size() > 2) {  // the limit is included
        const float limit = found[2].distance * 1.0000002f;
        const std::vector<ScenePoint> near = scene.nearest(points[i], count, limit);
        EXPECT_EQ(near,
                  scene.within(points[i], limit).size() > count ? found : scene.within(points[i], limit));
      }
    }
  }
}

TEST(ScenePoints, TheSurfaceIsToldFromTheInside) {
  const Bvh box = build(workbench::make_box({-1, -1, -1}, {1, 1, 1}).mesh());
  const Scene scene = build(
      std::vector<Instance>{{.object = box, .transform = {{{2, 0, 0, 10}, {0, 2, 0, 0}, {0, 0, 2, 0}}}},
                            {.object = box, .transform = {{{0, -1, 0, -10}, {1, 0, 0, 0}, {0, 0, 1, 0}}}}});
  const std::vector<Vec3f> points{{10, 0, 0},     {12, 0, 0}, {12, 2, 2}, {12.25f, 0, 0},
                                  {-10, 0.5f, 0}, {-9, 0, 0}, {0, 0, 0}};
  const std::vector<Side> expected{Side::inside, Side::on, Side::on,     Side::outside,
                                   Side::inside, Side::on, Side::outside};
  std::vector<Side> sides(points.size());
  scene.side(points, sides);
  EXPECT_EQ(sides, expected);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(scene.side(points[i]), expected[i]);
    EXPECT_EQ(scene.contains(points[i]), expected[i] != Side::outside);
  }
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(scene.side({infinity, 0, 0}), Side::outside);
}

TEST(ScenePoints, DistancesInScenesOfScenesAreThoseOfOneLevel) {
  std::mt19937 random(3);
  const World inner(random, 12), outer(random, 8);
  std::vector<Instance> nested, flat;
  for (std::size_t i = 0; i < outer.instances.size(); ++i) {
    const Transform& m = outer.instances[i].transform;
    nested.push_back({.scene = build(inner.instances), .transform = m});
    for (const Instance& instance : inner.instances) {
      flat.push_back(instance);
      const Transform& n = instance.transform;
      for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
          double& x = flat.back().transform.rows[row][column];
          x = column == 3 ? m.rows[row][3] : 0;
          for (std::size_t k = 0; k < 3; ++k) x += m.rows[row][k] * n.rows[k][column];
        }
      }
    }
  }
  const Scene scene = build(nested), one_level = build(flat);
  for (std::size_t i = 0; i < test::reduced(200); ++i) {
    const Vec3f point = uniform_point(random, 8.0f);
    const auto found = scene.closest_point(point), expected = one_level.closest_point(point);
    ASSERT_TRUE(found && expected);
    ASSERT_NEAR(found->distance, expected->distance, 1e-5);
    ASSERT_EQ(found->instance, expected->instance);
    ASSERT_EQ(found->primitive, expected->primitive);
    ASSERT_EQ(scene.within(point, 1.0f).size(), one_level.within(point, 1.0f).size());
  }
}

TEST(ScenePoints, DistancesAreNegativeInsideAnyInstance) {
  const Bvh object = build(workbench::make_sphere(4).mesh());
  const std::vector<Instance> instances{
      {.object = object},
      {.object = object, .transform = {{{3, 0, 0, 10}, {0, 3, 0, 0}, {0, 0, 3, 0}}}},
      {.object = object, .transform = {{{0.5, 0, 0, 0}, {0, 8, 0, 20}, {0, 0, 2, 0}}}}};
  const Scene scene = build(instances);
  EXPECT_NEAR(scene.signed_distance({0, 0, 0}), -1, 0.01);
  EXPECT_NEAR(scene.signed_distance({10, 0, 0}), -3, 0.03);
  EXPECT_NEAR(scene.signed_distance({0, 20, 0}), -0.5, 0.01);
  EXPECT_NEAR(scene.signed_distance({4, 0, 0}), 3, 0.03);
  EXPECT_NEAR(scene.signed_distance({0, 31, 0}), 3, 0.03);
  const std::vector<Vec3f> points{{0, 0, 0}, {4, 0, 0}, {0, 31, 0}};
  std::vector<ScenePoint> closest(3);
  scene.closest_point(points, closest);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(closest[i], scene.closest_point(points[i]));
}

TEST(ScenePoints, QuestionsWithoutSenseHaveNoAnswers) {
  const Instance instance{.object = build(workbench::make_sphere(2).mesh())};
  const Scene scene = build(std::span(&instance, 1));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(scene.closest_point({nan, 0, 0}));
  EXPECT_FALSE(scene.closest_point({0, 0, 0}, -1.0f));
  EXPECT_TRUE(scene.within({0, 0, 0}, nan).empty());
  EXPECT_FALSE(Scene().closest_point({0, 0, 0}));
  EXPECT_EQ(Scene().signed_distance({0, 0, 0}), std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace kerf
