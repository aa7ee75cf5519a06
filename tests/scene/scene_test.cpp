// Scenes against their flattened meshes where transforms are exact, and elsewhere against every instance by
// itself.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "base/parallel.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/instrumented.hpp"
#include "support/placed.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using adversarial::grid_point;
using adversarial::uniform;
using adversarial::uniform_point;
using kerf_tests::any_transform;
using kerf_tests::append_leaves;
using kerf_tests::Leaf;
using kerf_tests::scaled_and_moved;
using kerf_tests::scene_of_scenes;

Vec3f moved(const Transform& m, const Vec3f& p) {
  Vec3f to;
  for (int i = 0; i < 3; ++i)
    to[i] = static_cast<float>(m.rows[i][0] * p.x + m.rows[i][1] * p.y + m.rows[i][2] * p.z + m.rows[i][3]);
  return to;
}

// By Cramer's rule, in long doubles.
Ray to_object(const Transform& transform, const Ray& ray) {
  const auto& m = transform.rows;
  const auto solve = [&](long double x, long double y, long double z) {
    const long double v[3] = {x, y, z};
    const auto det = [](const long double(&a)[3][3]) {
      return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
             a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
             a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    long double all[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) all[i][j] = m[i][j];
    Vec3f solution;
    for (int j = 0; j < 3; ++j) {
      long double replaced[3][3];
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) replaced[i][k] = k == j ? v[i] : all[i][k];
      solution[j] = static_cast<float>(det(replaced) / det(all));
    }
    return solution;
  };
  const Vec3f &o = ray.origin, &d = ray.direction;
  return {.origin = solve(o.x - static_cast<long double>(m[0][3]), o.y - static_cast<long double>(m[1][3]),
                          o.z - static_cast<long double>(m[2][3])),
          .direction = solve(d.x, d.y, d.z),
          .t_min = ray.t_min,
          .t_max = ray.t_max};
}

SceneHit in_instance(const Hit& hit, std::uint32_t instance) {
  return {hit.t, hit.u, hit.v, hit.primitive, hit.mesh, instance};
}

void put_in_order(std::vector<SceneHit>& hits) {
  std::sort(hits.begin(), hits.end(), [](const SceneHit& a, const SceneHit& b) {
    return std::tie(a.t, a.instance, a.mesh, a.primitive) < std::tie(b.t, b.instance, b.mesh, b.primitive);
  });
}

// All instances, one by one.
std::vector<SceneHit> all_hits_one_by_one(std::span<const Instance> instances, const Ray& ray) {
  std::vector<SceneHit> hits;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    instances[i].object.all_hits(to_object(instances[i].transform, ray),
                                 [&](const Hit& hit) { hits.push_back(in_instance(hit, i)); });
  }
  put_in_order(hits);
  return hits;
}
SceneHit closest_one_by_one(std::span<const Instance> instances, const Ray& ray, Mask mask = {}) {
  SceneHit best;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    if ((instances[i].mask.bits & mask.bits) == 0) continue;
    const auto hit = instances[i].object.intersect(to_object(instances[i].transform, ray), mask);
    if (hit && hit->t < best.t) best = in_instance(*hit, i);
  }
  return best;
}

// Where floats hold all of it, cutting a scene into instances changes nothing at all. (A mirrored object may
// give a ray along an edge to the other triangle of that edge.)
TEST(Scene, HitsAreThoseOfTheFlattenedMeshWhereTransformsAreExact) {
  kerf_tests::for_each_target([](const Target&) {
    std::mt19937 random(1);
    const adversarial::Soup soup = adversarial::soup(40, [&] { return grid_point(random, 4); });
    const Bvh object = build(soup.mesh(), spatial_splits_everywhere());
    std::vector<Instance> instances;
    std::vector<Triangle> flat;
    for (std::uint32_t i = 0; i < 30; ++i) {
      const double scale = std::ldexp(1.0, static_cast<int>(random() % 4) - 2);
      instances.push_back({.object = object, .transform = scaled_and_moved(scale, grid_point(random, 12))});
      for (const Triangle& t : soup.triangles) {
        const Transform& m = instances.back().transform;
        flat.push_back({moved(m, t.v0), moved(m, t.v1), moved(m, t.v2)});
      }
    }
    const Scene scene = build(instances);
    const adversarial::Soup flattened(flat);
    const Bvh bvh = build(flattened.mesh());
    const auto in_scene = [&](const Hit& hit) {
      const auto count = static_cast<std::uint32_t>(soup.triangles.size());
      return SceneHit{hit.t, hit.u, hit.v, hit.primitive % count, 0, hit.primitive / count};
    };
    for (std::size_t i = 0; i < test::reduced(400); ++i) {
      Ray ray{.origin = grid_point(random, 16), .direction = grid_point(random, 3)};
      if (ray.direction == Vec3f{}) continue;
      if (i % 5 == 0) ray.t_max = 4.0f;
      const auto expected = bvh.intersect(ray);
      const auto hit = scene.intersect(ray);
      ASSERT_EQ(hit.has_value(), expected.has_value());
      if (hit) {
        ASSERT_EQ(*hit, in_scene(*expected));
      }
      ASSERT_EQ(scene.occluded(ray), expected.has_value());
      std::vector<SceneHit> hits, expected_hits;
      scene.all_hits(ray, [&](const SceneHit& each) { hits.push_back(each); });
      bvh.all_hits(ray, [&](const Hit& each) { expected_hits.push_back(in_scene(each)); });
      ASSERT_EQ(hits, expected_hits);
      ASSERT_EQ(scene.count_hits(ray), hits.size());
      ASSERT_EQ(scene.contains(ray.origin), bvh.contains(ray.origin));
    }
  });
}

TEST(Scene, HitsAreTheClosestOfAllInstancesUnderAnyTransform) {
  kerf_tests::for_each_target([](const Target&) {
    std::mt19937 random(2);
    const Bvh objects[] = {build(kerf_tests::random_triangles(60, 0.5f, 0.3f).mesh()),
                           build(workbench::make_sphere(3).mesh()), Bvh()};
    for (const float size : {1.0f, 1e-6f, 1e6f}) {
      std::vector<Instance> instances;
      for (std::uint32_t i = 0; i < 60; ++i)
        instances.push_back({.object = objects[i % 3], .transform = any_transform(random, size)});
      const Scene scene = build(instances);
      for (std::size_t i = 0; i < test::reduced(300); ++i) {
        Ray ray{.origin = uniform_point(random, 5.0f * size), .direction = uniform_point(random, 1.0f)};
        if (i % 3 == 0) {  // through a vertex of some instance
          const Instance& instance = instances[3 * (random() % 20) + 1];
          const auto triangle = instance.object.triangle({static_cast<std::uint32_t>(random() % 500), 0});
          ray.direction = moved(instance.transform, triangle->v0) - ray.origin;
        }
        if (i % 7 == 0) ray.direction[static_cast<int>(i % 3)] = 0.0f;
        const auto hit = scene.intersect(ray);
        ASSERT_EQ(hit.value_or(SceneHit{}), closest_one_by_one(instances, ray));
        ASSERT_EQ(scene.occluded(ray), hit.has_value());
        std::vector<SceneHit> hits;
        scene.all_hits(ray, [&](const SceneHit& each) { hits.push_back(each); });
        ASSERT_EQ(hits, all_hits_one_by_one(instances, ray));
      }
    }
  });
}

// Rays through the vertices and edges of closed objects, from their middle and from outside of all.
struct Leaks {
  std::size_t rays = 0, leaks = 0, parity_errors = 0;
};
void aim_at(const workbench::Solid& solid, const Scene& scene, const std::vector<Transform>& transforms,
            std::size_t rays, std::mt19937& random, Leaks& leaks) {
  const auto in_scene = [&](Vec3f p) {
    for (auto transform = transforms.rbegin(); transform != transforms.rend(); ++transform)
      p = moved(*transform, p);
    return p;
  };
  const Vec3f middle = in_scene({0, 0, 0});
  for (std::size_t i = 0; i < rays; ++i) {
    const auto& triangle = solid.triangles[random() % solid.triangles.size()];
    const Vec3f a = solid.vertices[triangle[0]], b = solid.vertices[triangle[1]];
    const Vec3f at = in_scene(a + uniform(random, 0, 1) * static_cast<float>(random() % 2) * (b - a));
    const Ray out{.origin = middle, .direction = at - middle};
    const Ray in{.origin = middle + 7.0f * out.direction, .direction = -1.0f * out.direction};
    leaks.leaks += !scene.intersect(out) || !scene.occluded(in);
    leaks.parity_errors += scene.count_hits(out) % 2 != 1 || scene.count_hits(in) % 2 != 0;
    ++leaks.rays;
  }
}

// KERF_RAYS=10000000 is the longer run of CONTRIBUTING.md.
TEST(Scene, NothingLeaksThroughInstancesNestedOrRefitted) {
  const char* const wanted = std::getenv("KERF_RAYS");
  const std::size_t rays = wanted ? std::strtoull(wanted, nullptr, 10) : test::reduced(24000);
  workbench::Solid bent = workbench::make_sphere(3);
  const workbench::Solid sphere = bent;
  const Bvh object = build(sphere.mesh(), spatial_splits_everywhere());
  for (Vec3f& v : bent.vertices) v = v * (1.0f + 0.2f * v.x * v.y) + Vec3f{0, 0, 0.1f * v.x * v.x};
  Bvh refitted = object;
  ASSERT_FALSE(refit(refitted, bent.mesh()).rebuilt);

  constexpr std::uint32_t seeds = 48;
  std::vector<Leaks> found(seeds);
  parallel_for(seeds, [&](std::uint32_t seed) {
    std::mt19937 random(seed);
    const bool is_refitted = seed % 2 == 1;
    std::vector<Transform> transforms;
    Scene scene;
    for (std::uint32_t level = 0; level < 1 + seed % 3; ++level) {
      Instance instance{.transform = any_transform(random, std::exp(uniform(random, -5, 5)))};
      if (level == 0) {
        instance.object = is_refitted ? refitted : object;
      } else {
        instance.scene = scene;
      }
      scene = build(std::span(&instance, 1));
      transforms.insert(transforms.begin(), instance.transform);
    }
    aim_at(is_refitted ? bent : sphere, scene, transforms, rays / seeds, random, found[seed]);
  });
  Leaks all;
  for (const Leaks& some : found) {
    all.rays += some.rays;
    all.leaks += some.leaks;
    all.parity_errors += some.parity_errors;
  }
  EXPECT_EQ(all.leaks, 0u);
  EXPECT_EQ(all.parity_errors, 0u);
  if (wanted) {
    std::cout << all.rays << " rays out and as many in, " << all.leaks << " leaks, " << all.parity_errors
              << " parity errors\n";
  }
}

// A direction in an object's space may be too long or too short for floats; its length means nothing.
TEST(Scene, HitsDoNotDependOnHowLongADirectionBecomes) {
  const Bvh object = build(workbench::make_sphere(3).mesh());
  for (const int exponent : {-60, 0, 60}) {
    const double size = std::ldexp(1.0, exponent);
    const Instance instance{.object = object, .transform = scaled_and_moved(size, {0, 0, 0})};
    const Scene scene = build(std::span(&instance, 1));
    const Vec3f from{static_cast<float>(-3 * size), static_cast<float>(0.1 * size),
                     static_cast<float>(0.2 * size)};
    const auto expected = object.intersect({.origin = {-3, 0.1f, 0.2f}, .direction = {1, 0.03f, 0.01f}});
    for (const int length : {-60, 0, 60}) {
      const float unit = std::ldexp(1.0f, length);
      const Ray ray{.origin = from, .direction = {unit, 0.03f * unit, 0.01f * unit}};
      const auto hit = scene.intersect(ray);
      ASSERT_TRUE(hit) << exponent << ' ' << length;
      EXPECT_NEAR(hit->t / std::ldexp(expected->t, exponent - length), 1.0, 1e-6);
      EXPECT_EQ(hit->primitive, expected->primitive);
      EXPECT_TRUE(scene.occluded(ray));
      EXPECT_EQ(scene.count_hits(ray), 2u);
      Ray shorter = ray;
      shorter.t_max = 0.99f * hit->t;
      EXPECT_FALSE(scene.occluded(shorter));
      EXPECT_FALSE(scene.intersect(shorter));
    }
  }
}

TEST(Scene, ScenesStandInScenesAndHitsNameThePath) {
  kerf_tests::for_each_target([](const Target&) {
    std::mt19937 random(8);
    const Bvh object = build(workbench::make_sphere(2).mesh());
    const Scene scene = scene_of_scenes(random, object);
    std::vector<Leaf> leaves;
    append_leaves(scene, {}, leaves);
    ASSERT_EQ(scene.instance_count(), leaves.size());
    for (std::uint32_t i = 0; i < leaves.size(); ++i) ASSERT_EQ(scene.path(i), leaves[i].path);
    for (std::size_t i = 0; i < test::reduced(300); ++i) {
      const Ray ray{.origin = uniform_point(random, 30), .direction = uniform_point(random, 1)};
      const Mask mask{static_cast<std::uint32_t>(random() % 8)};
      SceneHit closest, seen;
      std::vector<SceneHit> all;
      for (std::uint32_t k = 0; k < leaves.size(); ++k) {
        Ray local = ray;
        for (const Transform& transform : leaves[k].transforms) local = to_object(transform, local);
        leaves[k].object.all_hits(local, [&](const Hit& hit) {
          all.push_back(in_instance(hit, k));
          if (hit.t < closest.t) closest = all.back();
          if (leaves[k].is_seen(mask) && hit.t < seen.t) seen = all.back();
        });
      }
      put_in_order(all);
      std::vector<SceneHit> hits;
      scene.all_hits(ray, [&](const SceneHit& each) { hits.push_back(each); });
      ASSERT_EQ(hits, all);
      ASSERT_EQ(scene.count_hits(ray), all.size());
      ASSERT_EQ(scene.contains(ray.origin), all.size() % 2 == 1);
      ASSERT_EQ(scene.intersect(ray).value_or(SceneHit{}), closest);
      ASSERT_EQ(scene.occluded(ray), bool(closest));
      ASSERT_EQ(scene.intersect(ray, mask).value_or(SceneHit{}), seen);
      ASSERT_EQ(scene.occluded(ray, mask), bool(seen));
    }
  });
}

TEST(Scene, RaysSeeInstancesAndMeshesThatTheyShareABitWith) {
  const workbench::Solid sphere = workbench::make_sphere(2);
  TriangleMesh inner = sphere.mesh(), outer = sphere.mesh();
  workbench::Solid large = sphere;
  for (Vec3f& v : large.vertices) v = v * 2.0f;
  outer = large.mesh();
  inner.mask = {1};
  outer.mask = {2};
  const Bvh object = build(std::array{inner, outer});
  std::vector<Instance> instances;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Vec3f by{6.0f * static_cast<float>(i), 0, 0};
    instances.push_back(
        {.object = object, .transform = scaled_and_moved(1, by), .mask = {i}, .number = 100 + i});
  }
  const Scene scene = build(instances);
  std::vector<Ray> rays;
  std::vector<std::uint32_t> masks;
  for (std::uint32_t bits = 0; bits < 4; ++bits) {
    for (const float x : {-9.0f, 3.0f, 9.0f, 15.0f}) {
      const Ray ray{.origin = {x, 0.1f, 0.2f}, .direction = {1, 0, 0}};
      const SceneHit expected = closest_one_by_one(instances, ray, {bits});
      EXPECT_EQ(scene.intersect(ray, Mask{bits}).value_or(SceneHit{}), expected);
      EXPECT_EQ(scene.occluded(ray, Mask{bits}), bool(expected));
      rays.push_back(ray);
      masks.push_back(bits);
    }
  }
  RayView view = rays;
  view.mask = {masks.data()};
  std::vector<SceneHit> hits(rays.size());
  std::vector<char> occluded(rays.size());
  scene.intersect(view, hits);
  scene.occluded(view, occluded);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits[i], closest_one_by_one(instances, rays[i], {masks[i]}));
    EXPECT_EQ(occluded[i] != 0, bool(hits[i]));
  }
  EXPECT_EQ(scene.instances()[2].number, 102u);
}

TEST(Scene, ManyRaysAndPointsAreAnsweredAsOneByOne) {
  std::mt19937 random(6);
  const Bvh object = build(workbench::make_torus(20, 10).mesh());
  std::vector<Instance> instances;
  for (int i = 0; i < 3000; ++i) {
    Transform transform = any_transform(random, 1.0f);
    for (auto& row : transform.rows) row[3] *= 10.0;
    instances.push_back({.object = object, .transform = transform});
  }
  const Scene scene = build(instances), on_one_thread = build(instances, {.threads = 1});
  std::vector<Ray> rays;
  std::vector<Vec3f> points;
  for (int i = 0; i < 3000; ++i) {
    points.push_back(uniform_point(random, 40.0f));
    rays.push_back({.origin = points.back(), .direction = uniform_point(random, 1.0f)});
  }
  std::vector<SceneHit> hits(rays.size());
  std::vector<char> occluded(rays.size()), inside(rays.size());
  scene.intersect(rays, hits);
  scene.occluded(rays, occluded);
  scene.contains(points, inside);
  std::vector<std::uint32_t> counts(rays.size());
  std::vector<float> distances(points.size());
  scene.count_hits(rays, counts);
  scene.signed_distance(points, distances);
  const auto all = scene.all_hits(rays), all_on_one_thread = scene.all_hits(rays, {.threads = 1});
  const auto within = scene.within(points, 2.0f);
  EXPECT_EQ(all.items, all_on_one_thread.items);
  EXPECT_EQ(all.offsets, all_on_one_thread.offsets);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(hits[i], on_one_thread.intersect(rays[i]).value_or(SceneHit{}));
    ASSERT_EQ(occluded[i] != 0, bool(hits[i]));
    ASSERT_EQ(inside[i] != 0, scene.contains(points[i]));
    ASSERT_EQ(counts[i], scene.count_hits(rays[i]));
    ASSERT_EQ(distances[i], scene.signed_distance(points[i]));
    std::vector<SceneHit> one;
    scene.all_hits(rays[i], [&](const SceneHit& hit) { one.push_back(hit); });
    ASSERT_TRUE(std::ranges::equal(all[i], one));
    ASSERT_TRUE(std::ranges::equal(within[i], scene.within(points[i], 2.0f)));
  }
  hits.pop_back();
  counts.pop_back();
  distances.pop_back();
  EXPECT_THROW(scene.intersect(rays, hits), Error);
  EXPECT_THROW(scene.count_hits(rays, counts), Error);
  EXPECT_THROW(scene.signed_distance(points, distances), Error);
}

TEST(Scene, TheOrderOfEqualHitsIsThatOfInstances) {
  const Bvh object = build(workbench::make_sphere(2).mesh());
  const std::vector<Instance> instances(5, Instance{.object = object});
  const Scene scene = build(instances);
  const Ray ray{.origin = {-3, 0.1f, 0.2f}, .direction = {1, 0, 0}};
  EXPECT_EQ(scene.intersect(ray)->instance, 0u);
  std::uint32_t next = 0;
  scene.all_hits(ray, [&](const SceneHit& hit) {
    EXPECT_EQ(hit.instance, next++ % 5);
    return next < 8;
  });
  EXPECT_EQ(next, 8u);
}

TEST(Scene, ScenesOfNothingAreMissed) {
  Scene empty = build(std::span<const Instance>());
  const Instance nothing{};
  for (const Scene& scene : {Scene(), empty, build(std::span(&nothing, 1))}) {
    EXPECT_FALSE(scene.intersect({.origin = {0, 0, 0}, .direction = {1, 0, 0}}));
    EXPECT_FALSE(scene.occluded({.origin = {0, 0, 0}, .direction = {1, 0, 0}}));
    EXPECT_FALSE(scene.contains({0, 0, 0}));
    EXPECT_TRUE(scene.bounds().empty());
  }
  const Scene moved_to = std::move(empty);
  EXPECT_EQ(moved_to.instances().size(), 0u);
}

TEST(Scene, InstancesOfNothingAreSkippedAmongThousands) {
  const Bvh object = build(workbench::make_sphere(0).mesh());
  std::vector<Instance> instances(3000);
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (i % 3 != 0) instances[i].object = object;
    instances[i].transform = {{{0.2, 0, 0, static_cast<double>(i)}, {0, 0.2, 0, 0}, {0, 0, 0.2, 0}}};
  }
  const Scene scene = build(instances);
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const auto hit = scene.intersect({.origin = {static_cast<float>(i), 0.01f, 5}, .direction = {0, 0, -1}});
    ASSERT_EQ(hit.has_value(), i % 3 != 0) << i;
    if (hit) {
      EXPECT_EQ(hit->instance, i);
    }
  }
  instances[2400].transform.rows[1][2] = std::numeric_limits<double>::quiet_NaN();  // an empty one
  try {
    build(instances);
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("instance 2400"), std::string::npos) << error.what();
  }
}

TEST(Scene, TransformsThatCannotBeInvertedAreRefusedByTheirNumber) {
  const Bvh object = build(workbench::make_sphere(1).mesh());
  const auto refusal = [&](const Transform& transform) -> std::string {
    const Instance instances[] = {{.object = object}, {.object = object, .transform = transform}};
    try {
      build(instances);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::invalid_argument);
      return error.what();
    }
    return {};
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal({{{1, 0, 0, nan}, {0, 1, 0, 0}, {0, 0, 1, 0}}}).find("instance 1"), std::string::npos);
  EXPECT_NE(refusal({{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 0}}}), "");
  EXPECT_NE(refusal({{{1, 1, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 0}}}), "");
  EXPECT_NE(refusal({{{1, 0, 0, 1e300}, {0, 1, 0, 0}, {0, 0, 1, 0}}}), "");
  EXPECT_NE(refusal({{{1e300, 0, 0, 0}, {0, 1e300, 0, 0}, {0, 0, 1e300, 0}}}), "");
  EXPECT_EQ(refusal({{{1e-12, 0, 0, 0}, {0, 1e12, 0, 0}, {0, 0, 1, 5}}}), "");
}

TEST(Scene, WhatCannotStandAtAPlaceIsRefusedByName) {
  const auto refusal = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  Instance instance{.object = build(workbench::make_sphere(1).mesh())};
  Scene scene = build(std::span(&instance, 1));
  Instance both = instance;
  both.scene = scene;
  EXPECT_EQ(refusal([&] { build(std::span(&both, 1)); }), "instance 0 has an object and a scene");
  EXPECT_EQ(refusal([&] { (void)scene.path(1); }), "instance 1 is not below the number of instances, 1");
  for (unsigned level = 2; level <= max_scene_levels; ++level) {
    const Instance nested{.scene = scene};
    scene = build(std::span(&nested, 1));
  }
  EXPECT_TRUE(scene.intersect({.origin = {-3, 0.1f, 0.2f}, .direction = {1, 0, 0}}));
  EXPECT_EQ(scene.path(0), std::vector<std::uint32_t>(max_scene_levels, 0));
  const Instance nested{.scene = scene};
  EXPECT_EQ(refusal([&] { build(std::span(&nested, 1)); }), "9 levels of scenes are more than 8");
  // 200^5 instances are more than 2^32.
  std::vector<Instance> many(200, instance);
  EXPECT_NE(refusal([&] {
              for (int level = 0; level < 5; ++level) {
                const Scene wide = build(many);
                many.assign(200, Instance{.scene = wide});
              }
            }),
            "");
}

}  // namespace
}  // namespace kerf
