// Degenerate and extreme meshes: every builder builds them, and all hierarchies give the same answers.
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>

#include "support/adversarial.hpp"
#include "support/brute_force.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"

namespace kerf {
namespace {

using namespace adversarial;

struct Hostile {
  std::string name;
  Soup soup;
};

Triangle scaled(const Triangle& t, float s) {
  return {s * t.v0, s * t.v1, s * t.v2};
}

std::vector<Triangle> random_triangles(std::mt19937& random, std::size_t count, float scale) {
  std::vector<Triangle> triangles = soup(count, [&] { return uniform_point(random, 1.0f); }).triangles;
  for (Triangle& t : triangles) t = scaled(t, scale);
  return triangles;
}

std::vector<Hostile> hostile_meshes() {
  std::mt19937 random(1);
  std::vector<Hostile> meshes;
  const Triangle one{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  meshes.push_back({"one triangle", Soup({one})});
  meshes.push_back({"100,000 copies of one triangle", Soup(std::vector<Triangle>(100000, one))});
  for (const float scale : {1e9f, 1e-9f, 1e-40f, 8e37f}) {
    meshes.push_back({"coordinates around " + std::to_string(std::log10(scale)),
                      Soup(random_triangles(random, 500, scale))});
  }

  std::vector<Triangle> plane, nested, slivers, twins, mixed;
  for (int i = 0; i < 2000; ++i) {
    Triangle t{uniform_point(random, 1.0f), uniform_point(random, 1.0f), uniform_point(random, 1.0f)};
    slivers.push_back({t.v0, t.v0 + 1e-8f * uniform_point(random, 1.0f), t.v1});
    twins.push_back(t);
    twins.push_back({t.v1, t.v2, t.v0});
    mixed.push_back(i % 2 ? t : scaled(t, std::pow(10.0f, uniform(random, -30.0f, 30.0f))));
    t.v0.z = t.v1.z = t.v2.z = 0.5f;
    plane.push_back(t);
    const float s = 1.0f - static_cast<float>(i) / 2000.0f;
    nested.push_back({{-s, -s, 0}, {s, -s, 0}, {0, s, 0}});
  }
  meshes.push_back({"all in one plane", Soup(plane)});
  meshes.push_back({"nested in one plane", Soup(nested)});
  meshes.push_back({"slivers of aspect 1e8", Soup(slivers)});
  meshes.push_back({"every triangle twice", Soup(twins)});
  meshes.push_back({"sizes from 1e-30 to 1e30", Soup(mixed)});

  std::vector<Triangle> degenerate(1000, Triangle{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}});
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(i);
    degenerate.push_back({{x, x, x}, {2 * x, 2 * x, 2 * x}, {-x, -x, -x}});
  }
  meshes.push_back({"nothing but degenerate triangles", Soup(degenerate)});
  meshes.push_back({"nothing", Soup({})});
  return meshes;
}

std::vector<Hit> gather(const Bvh& bvh, const Ray& ray) {
  std::vector<Hit> hits;
  bvh.all_hits(ray, [&](const Hit& hit) { hits.push_back(hit); });
  return hits;
}

TEST(HostileMeshes, EveryBuilderGivesTheSameAnswers) {
  for (const auto& [name, mesh] : hostile_meshes()) {
    SCOPED_TRACE(name);
    std::vector<Bvh> hierarchies;
    for (const BuilderInfo& info : builders()) {
      BuildOptions options;
      options.builder = info.builder;
      if (info.builder == Builder::sbvh) options.alpha = 0.0f;
      hierarchies.push_back(build(mesh.mesh(), options));
    }
    const BvhStatistics& statistics = hierarchies[0].statistics();
    ASSERT_EQ(statistics.triangles, mesh.triangles.size());
    const float infinity = std::numeric_limits<float>::infinity();
    for (const Bvh& bvh : hierarchies) {
      ASSERT_EQ(bvh.statistics().degenerate_triangles, statistics.degenerate_triangles);
      ASSERT_EQ(bvh.triangles_in({{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}).size(),
                statistics.triangles - statistics.degenerate_triangles);
    }
    if (mesh.triangles.empty()) continue;
    std::mt19937 random(2);
    const int rays = mesh.triangles.size() > 10000 ? 3 : 60;
    for (int i = 0; i < rays; ++i) {
      const Ray ray = aim(random, mesh.triangles[random() % mesh.triangles.size()], 1.0f);
      const std::vector<Hit> all = gather(hierarchies[0], ray);
      const auto closest = hierarchies[0].intersect(ray);
      for (const Bvh& bvh : hierarchies) {
        ASSERT_EQ(gather(bvh, ray), all);
        ASSERT_EQ(bvh.intersect(ray), closest);
        ASSERT_EQ(bvh.occluded(ray), closest.has_value());
        ASSERT_EQ(bvh.closest_point(ray.origin), hierarchies[0].closest_point(ray.origin));
      }
    }
  }
}

// Distances along such rays overflow. They may then meet boxes that no ray meets, those of unused slots too.
TEST(HostileMeshes, OfOrdersOfMagnitudeApartOnlyTrianglesAreHit) {
  std::mt19937 random(5);
  const auto wild = [&] {
    return std::ldexp(uniform(random, -1.0f, 1.0f), static_cast<int>(random() % 265) - 140);
  };
  std::size_t hits = 0;
  for (int scene = 0; scene < 200; ++scene) {
    std::vector<Vec3f> vertices(3 * (1 + random() % 20));
    for (Vec3f& vertex : vertices) vertex = {wild(), wild(), random() % 2 ? wild() : 0.0f};
    std::vector<std::uint32_t> indices(vertices.size());
    std::iota(indices.begin(), indices.end(), 0u);
    const TriangleMesh mesh{.vertices = vertices, .triangles = indices};
    const Bvh bvh = build(mesh);
    for (int i = 0; i < 200; ++i) {
      const Vec3f& a = vertices[random() % vertices.size()];
      const Vec3f& b = vertices[random() % vertices.size()];
      const float s = uniform(random, 0.0f, 1.0f);
      const Ray ray{.origin = s * a + (1.0f - s) * b, .direction = {wild(), wild(), wild()}};
      const auto hit = bvh.intersect(ray);
      if (!hit) continue;
      ASSERT_LT(hit->primitive, indices.size() / 3);
      const std::span own = std::span(indices).subspan(3 * hit->primitive, 3);
      const auto alone = brute_force({.vertices = vertices, .triangles = own}, ray, bvh.bounds());
      ASSERT_TRUE(alone.has_value()) << "scene " << scene << ", ray " << i;
      EXPECT_EQ(alone->t, hit->t);
      ++hits;
    }
  }
  EXPECT_GT(hits, 100u);
}

// One face is degenerate as far as double precision can tell, but without it the solid has a hole.
TEST(HostileMeshes, ASolidKeepsTheThinnestOfItsFaces) {
  std::mt19937 random(6);
  for (const float shift : {1e-8f, 1e-18f, 1e-45f}) {
    const Vec3f a{shift, 0, 0}, b{1, 1, 1}, c{3, 3, 3}, d{0, 0, 5};
    const Soup solid({{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}});
    const Bvh bvh = build(solid.mesh());
    EXPECT_EQ(bvh.statistics().degenerate_triangles, 0u) << shift;
    for (int i = 0; i < 1000; ++i) {
      const Vec3f origin{9, -7, 3}, at = uniform(random, 0.0f, 3.0f) * b;
      EXPECT_EQ(gather(bvh, {.origin = origin, .direction = at - origin}).size() % 2, 0u) << shift;
    }
  }
}

TEST(HostileMeshes, CornersInOneLineAreDegenerateHoweverFarApart) {
  std::mt19937 random(7);
  std::vector<Triangle> lines;
  while (lines.size() < 1000) {
    const auto on_line = [&, along = Vec3f{1, 3, 5}] {
      const auto steps = static_cast<float>(1 + random() % (1u << 21));
      return std::ldexp(steps, static_cast<int>(random() % 80) - 40) * along;
    };
    lines.push_back({on_line(), on_line(), on_line()});
  }
  EXPECT_EQ(build(Soup(lines).mesh()).statistics().degenerate_triangles, lines.size());
}

TEST(HostileMeshes, CoordinatesBeyondAQuarterOfTheRangeAreRefused) {
  for (const float beyond : {0x1p126f, 3.4e38f, -3.4e38f}) {
    const Soup mesh({Triangle{{0, 0, 0}, {1, 0, beyond}, {0, 1, 0}}});
    try {
      (void)build(mesh.mesh());
      FAIL() << beyond;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::non_finite_vertex) << error.what();
    }
  }
  EXPECT_NO_THROW((void)build(Soup({Triangle{{0, 0, 0}, {1, 0, 8.5e37f}, {0, 1, 0}}}).mesh()));
}

TEST(HostileMeshes, AnswersAtTheEndsOfTheRangeAreExact) {
  std::mt19937 random(3);
  for (const float scale : {1e-40f, 1e-30f, 1e30f, 8e37f}) {
    const Soup mesh(random_triangles(random, 40, scale));
    const Bvh bvh = build(mesh.mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 50; ++i) {
      const Triangle& target = mesh.triangles[random() % mesh.triangles.size()];
      const Vec3f origin = 0.5f * uniform_point(random, scale);
      const Ray ray{.origin = origin, .direction = 0.5f * target.v0 - 0.5f * origin};
      if (ray.direction == Vec3f{}) continue;
      const std::vector<Hit> hits = gather(bvh, ray);
      std::size_t must = 0, may = 0;
      for (const Triangle& triangle : mesh.triangles) {
        const exact::Crossing truth = exact::cross_line(ray.origin, ray.direction, triangle);
        if (truth.meeting == exact::Meeting::none || truth.t < 0) continue;
        (truth.meeting == exact::Meeting::interior ? must : may)++;
      }
      EXPECT_GE(hits.size(), must);
      EXPECT_LE(hits.size(), must + may);
    }
  }
}

}  // namespace
}  // namespace kerf
