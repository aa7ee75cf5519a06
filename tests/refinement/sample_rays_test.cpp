// Trees that are made for rays that are known.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "build.hpp"
#include "refinement/expected_visits.hpp"
#include "refinement/ray_flux.hpp"
#include "refinement/sample_ways.hpp"
#include "support/progress.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"
#include "tree/validate.hpp"
#include "workbench/generate/generated_scenes.hpp"

namespace kerf {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr Quality qualities[] = {Quality::fast, Quality::high, Quality::best};

workbench::Scene make_city(double triangles = 5000.0) {
  const workbench::GeneratedScene& city = *workbench::find_generated_scene("city");
  return city.generate(triangles / static_cast<double>(city.default_triangles));
}

// From the viewpoints into their pictures; other ones for another seed.
std::vector<Ray> camera_rays(const workbench::Scene& scene, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  std::vector<Ray> rays;
  for (const workbench::Viewpoint& viewpoint : scene.viewpoints) {
    const Vec3f ahead = viewpoint.target - viewpoint.position;
    const float width = std::sqrt(dot(ahead, ahead));
    for (int i = 0; i < 1000; ++i) {
      const Vec3f aside{uniform(random), uniform(random), uniform(random)};
      rays.push_back({viewpoint.position, ahead + width * aside});
    }
  }
  return rays;
}

// As the collapse counts it: see `CollapseCosts`.
double cost_of(const Bvh& bvh, const std::vector<Ray>& rays) {
  TraversalCounters counters;
  for (const Ray& ray : rays) (void)intersect(bvh, ray, counters);
  return static_cast<double>(counters.steps) + 0.4 * static_cast<double>(counters.leaves) +
         0.03 * static_cast<double>(counters.triangle_tests);
}

std::vector<Ray> random_ways(const Box3f& box, std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const Vec3f size = box.upper - box.lower;
  std::vector<Ray> ways(count);
  for (Ray& way : ways) {
    for (int axis = 0; axis < 3; ++axis) {
      way.origin[axis] = box.lower[axis] + (2.0f * uniform(random) - 0.5f) * size[axis];
      way.direction[axis] = uniform(random) - 0.5f;
    }
    way.t_max = uniform(random) * (size.x + size.y + size.z);
  }
  return ways;
}

// In double precision.
bool meets(const Ray& way, const Box3f& box) {
  double enter = way.t_min, leave = way.t_max;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (double{box.lower[axis]} - way.origin[axis]) / way.direction[axis];
    const double b = (double{box.upper[axis]} - way.origin[axis]) / way.direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

TEST(SampleRays, TheFluxOfABoxIsTheNumberOfRaysThatMeetIt) {
  constexpr float side = static_cast<float>(RayFlux::cells);
  const Box3f scene{{-side, 0.0f, side}, {side, side, 5.0f * side}};  // cells of 2, 1 and 4
  const std::vector<Ray> ways = random_ways(scene, 4000);
  const RayFlux flux(scene, ways), nothing(scene, {});
  std::mt19937 random(4);
  std::uniform_int_distribution<int> plane(0, RayFlux::cells);
  for (int i = 0; i < 100; ++i) {
    Box3f box;
    for (int axis = 0; axis < 3; ++axis) {
      const float cell = (scene.upper[axis] - scene.lower[axis]) / side;
      int first = plane(random), last = plane(random);
      if (last < first) std::swap(first, last);
      box.lower[axis] = scene.lower[axis] + cell * static_cast<float>(first);
      box.upper[axis] = scene.lower[axis] + cell * static_cast<float>(last);
    }
    const auto count =
        std::count_if(ways.begin(), ways.end(), [&](const Ray& way) { return meets(way, box); });
    // Rays that go everywhere are added, and no more to this box than to the scene: 32 and one of 200.
    const float added = (32.0f + 0.005f * 4000.0f) * half_area(box) / half_area(scene);
    // A ray through an edge may count twice, or not at all.
    EXPECT_NEAR(flux(box), static_cast<float>(count) + added, 2.0f) << i;
    EXPECT_NEAR(nothing(box), 32.0f * half_area(box) / half_area(scene), 1e-3f);
  }
}

TEST(SampleRays, TheFluxGrowsEvenlyFromPlaneToPlane) {
  const Box3f scene{{0, 0, 0}, {64, 64, 64}};
  const std::vector<Ray> ways = random_ways(scene, 2000);
  const RayFlux flux(scene, ways);
  const auto at = [&](float x) { return flux({{8, 8, 8}, {x, 40, 40}}); };
  EXPECT_NEAR(at(20.25f), 0.75f * at(20.0f) + 0.25f * at(21.0f), 0.01f);
}

TEST(SampleRays, AFlatSceneIsMeasuredAsWell) {
  const Box3f scene{{0, 0, 1}, {4, 4, 1}};
  std::vector<Ray> down;
  for (int i = 0; i < 100; ++i)
    down.push_back({{0.02f + 0.01f * static_cast<float>(i), 1.0f, 3.0f}, {0, 0, -1}, 0.0f, 2.0f});
  const RayFlux flux(scene, down);
  EXPECT_GT(flux({{0, 0, 1}, {2, 2, 1}}), 100.0f);
  EXPECT_LT(flux({{2, 2, 1}, {4, 4, 1}}), 50.0f);
}

TEST(SampleRays, VisitsAreWhatIsCountedWhereMuchIs) {
  const workbench::Scene scene = make_city();
  const TriangleMesh mesh = scene.mesh();
  const Geometry geometry({&mesh, 1});
  BinaryTree tree = make_tree(geometry, {});
  const std::vector<Ray> ways = trace_to_hits(tree, geometry, camera_rays(scene, 0), {});
  expect_visits(tree, ways);
  ASSERT_EQ(tree.visits.size(), tree.nodes.size());
  std::size_t large = 0;
  for (std::size_t n = 0; n < tree.nodes.size(); n += 7) {
    const Box3f& box = tree.nodes[n].bounds;
    const auto count =
        std::count_if(ways.begin(), ways.end(), [&](const Ray& way) { return meets(way, box); });
    EXPECT_GT(tree.visits[n], 0.0f);
    if (count < 200) continue;
    ++large;
    EXPECT_NEAR(tree.visits[n], static_cast<float>(count), 0.15f * static_cast<float>(count)) << n;
  }
  EXPECT_GT(large, 5u);
}

TEST(SampleRays, AWayEndsAtTheClosestHit) {
  const workbench::Scene scene = make_city(2000.0);
  const TriangleMesh mesh = scene.mesh();
  const Geometry geometry({&mesh, 1});
  const Bvh bvh = build(mesh);
  const std::vector<Ray> rays = camera_rays(scene, 0);
  const std::vector<Ray> ways = trace_to_hits(make_tree(geometry, {}), geometry, rays, {});
  ASSERT_EQ(ways.size(), rays.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto hit = bvh.intersect(rays[i]);
    const float end = hit ? hit->t : rays[i].t_max;
    // What passes an edge by a rounding is a statistic's own affair.
    different += !(ways[i].t_max == end || std::abs(ways[i].t_max - end) <= 1e-4f * end);
  }
  EXPECT_LE(different, rays.size() / 1000);
}

void expect_less(const workbench::Scene& scene, Quality quality) {
  const std::vector<Ray> known = camera_rays(scene, 0), others = camera_rays(scene, 1);
  kerf_tests::for_each_target([&](const Target&) {
    const double without = cost_of(build(scene.mesh(), {.quality = quality}), others);
    const double with = cost_of(build(scene.mesh(), {.quality = quality, .sample_rays = known}), others);
    EXPECT_LT(with, without) << static_cast<int>(quality);
  });
}

TEST(SampleRays, OtherRaysOfTheirKindCostLess) {
  // Narrow nodes leave the collapse little choice: what it gains shows in larger trees.
  expect_less(make_city(20000.0), Quality::fast);
  const workbench::Scene small = make_city();
  expect_less(small, Quality::high);
  expect_less(small, Quality::best);
}

TEST(SampleRays, HitsDoNotDependOnThem) {
  const workbench::Scene scene = make_city();
  const std::vector<Ray> known = camera_rays(scene, 0), others = camera_rays(scene, 1);
  const Bvh plain = build(scene.mesh());
  for (const Quality quality : qualities) {
    const Bvh made = build(scene.mesh(), {.quality = quality, .sample_rays = known});
    std::size_t different = 0;
    for (const Ray& ray : others) {
      different += made.intersect(ray) != plain.intersect(ray);
      different += made.occluded(ray) != plain.occluded(ray);
      different += made.count_hits(ray) != plain.count_hits(ray);
    }
    EXPECT_EQ(different, 0u);
  }
}

TEST(SampleRays, TheTreeIsTheSameForAllThreadsAndInstructionSets) {
  const workbench::Scene scene = make_city();
  const TriangleMesh mesh = scene.mesh();
  const Geometry geometry({&mesh, 1});
  const std::vector<Ray> known = camera_rays(scene, 0);
  for (const Quality quality : {Quality::fast, Quality::best}) {
    const BinaryTree expected = make_tree(geometry, {.quality = quality, .sample_rays = known, .threads = 1});
    const auto expect_same = [&](unsigned threads) {
      const BinaryTree tree =
          make_tree(geometry, {.quality = quality, .sample_rays = known, .threads = threads});
      EXPECT_EQ(tree.visits, expected.visits);
      EXPECT_EQ(tree.references, expected.references);
      EXPECT_TRUE(std::equal(tree.nodes.begin(), tree.nodes.end(), expected.nodes.begin(),
                             expected.nodes.end(), [](const BinaryNode& a, const BinaryNode& b) {
                               return a.bounds == b.bounds && a.first == b.first && a.count == b.count;
                             }));
    };
    for (const unsigned threads : {2u, 7u}) expect_same(threads);
    kerf_tests::for_each_target([&](const Target&) { expect_same(0); });
  }
}

TEST(SampleRays, StrangeRaysLeaveAValidTree) {
  const kerf_tests::Mesh mesh = kerf_tests::random_triangles(1500, 0.5f, 0.01f);
  const TriangleMesh view = mesh.mesh();
  const Geometry geometry({&view, 1});
  const Ray plain{{0.5f, 0.5f, -1.0f}, {0, 0, 1}};
  const std::vector<std::vector<Ray>> sets = {
      {{{nan, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {nan, nan, nan}}, {{0, 0, 0}, {0, 0, 0}}},
      {{{infinity, 0, 0}, {-1, 0, 0}},
       {{0.5f, 0.5f, 0.5f}, {infinity, 0, 0}},
       {{3e38f, 0, 0}, {-3e38f, 0, 0}}},
      {{{0.5f, 0.5f, 0.5f}, {1, 1, 1}, -infinity, infinity}, {{0.5f, 0.5f, 0.5f}, {1e-40f, 0, 0}}},
      {{{0, 0, 0}, {1, 0, 0}, 2.0f, 1.0f}, {{9, 9, 9}, {1, 1, 1}}},
      {plain},
      std::vector<Ray>(3000, plain)};
  for (std::size_t i = 0; i < sets.size(); ++i) {
    for (const Quality quality : qualities) {
      const BinaryTree tree = make_tree(geometry, {.quality = quality, .sample_rays = sets[i]});
      EXPECT_EQ(validate(tree, geometry, max_tree_depth), std::vector<std::string>{}) << i;
      EXPECT_TRUE(std::all_of(tree.visits.begin(), tree.visits.end(), [](float visits) {
        return visits > 0.0f && std::isfinite(visits);
      })) << i;
    }
  }
}

TEST(SampleRays, SmallAndTinyMeshesAreBuilt) {
  const Ray ray{{0.5f, 0.5f, -1.0f}, {0, 0, 1}};
  for (const std::uint32_t count : {0u, 1u, 9u, 100u}) {
    for (const float scale : {1.0f, 1e-19f, 1e-30f, 1e18f, 1e30f}) {
      kerf_tests::Mesh mesh = kerf_tests::random_triangles(count, 0.5f, 0.1f);
      for (Vec3f& vertex : mesh.vertices) vertex = {vertex.x * scale, vertex.y * scale, vertex.z * scale};
      for (const Quality quality : qualities) {
        const Bvh bvh = build(mesh.mesh(), {.quality = quality, .sample_rays = {&ray, 1}});
        const Bvh plain = build(mesh.mesh());
        for (const Vec3f& vertex : mesh.vertices) {
          const Ray through{ray.origin, vertex - ray.origin};
          EXPECT_EQ(bvh.intersect(through), plain.intersect(through));
        }
      }
    }
  }
}

TEST(SampleRays, FewAreTracedWhereEachTestsEveryTriangle) {
  kerf_tests::Mesh mesh = kerf_tests::random_triangles(1, 0.5f, 0.5f);
  mesh.triangles.resize(2000, mesh.triangles.front());
  const TriangleMesh view = mesh.mesh();
  const Geometry geometry({&view, 1});
  const Triangle corners = geometry.triangle(0);
  Vec3f middle;
  for (const Vec3f& corner : {corners.v0, corners.v1, corners.v2}) middle = middle + (1.0f / 3.0f) * corner;
  const std::vector<Ray> rays(5000, Ray{{middle.x, middle.y, middle.z + 1.0f}, {0, 0, -1}});
  const std::vector<Ray> ways = trace_to_hits(make_tree(geometry, {}), geometry, rays, {}, 1u << 20);
  EXPECT_GE(ways.size(), 128u);
  EXPECT_LT(ways.size(), 5000u);
}

TEST(SampleRays, OfManySomeAreTakenEvenly) {
  std::vector<Ray> rays(2 * max_sample_rays + 2);
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i].t_max = static_cast<float>(i);
  const std::vector<Ray> picked = pick_samples(rays);
  ASSERT_EQ(picked.size(), max_sample_rays);
  EXPECT_EQ(picked[0].t_max, 0.0f);
  EXPECT_EQ(picked[max_sample_rays / 2].t_max, static_cast<float>(max_sample_rays + 1));
  EXPECT_GE(picked.back().t_max, static_cast<float>(rays.size() - 4));
}

TEST(SampleRays, ABuildForThemTellsItsProgressAndStopsWhenTold) {
  const workbench::Scene scene = make_city();
  const std::vector<Ray> known = camera_rays(scene, 0);
  for (const Quality quality : qualities)
    kerf_tests::expect_progress_and_cancelling(scene.mesh(), {.quality = quality, .sample_rays = known});
}

// A mesh in double precision has an origin of its own, and rays come in the coordinates of the mesh.
TEST(SampleRays, OfAMeshFarAwayAreInItsCoordinates) {
  const workbench::Scene scene = make_city();
  std::vector<std::array<double, 3>> vertices;
  for (const Vec3f& v : scene.vertices)
    vertices.push_back({double{v.x} + 524288.0, double{v.y} + 4194304.0, double{v.z}});
  const DoubleMesh far_away{.vertices = vertices, .triangles = scene.triangles};
  std::vector<Ray> known = camera_rays(scene, 0), others = camera_rays(scene, 1);
  for (Ray& ray : known) {
    ray.origin.x += 524288.0f;
    ray.origin.y += 4194304.0f;
  }
  const Bvh plain = build(far_away), made = build(far_away, {.sample_rays = known});
  ASSERT_NE(plain.origin().x, 0.0);
  for (Ray& ray : others) {
    ray = plain.to_local(
        DoubleRay{{double{ray.origin.x} + 524288.0, double{ray.origin.y} + 4194304.0, double{ray.origin.z}},
                  {double{ray.direction.x}, double{ray.direction.y}, double{ray.direction.z}}});
  }
  EXPECT_LT(cost_of(made, others), cost_of(plain, others));
}

}  // namespace
}  // namespace kerf
