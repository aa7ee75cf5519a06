// Rays with filters in scenes: against the first of all their hits that passes.
#include <algorithm>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/instrumented.hpp"
#include "support/placed.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"

namespace kerf {
namespace {

using adversarial::uniform_point;

// Large triangles, which stand in many leaves, at many places.
struct SceneFiltered : testing::Test {
  kerf_tests::Mesh mesh = kerf_tests::random_triangles(60, 0.8f, 0.3f);

  Scene scene() const {
    std::mt19937 random(2);
    return kerf_tests::scene_of_scenes(random, build(mesh.mesh(), spatial_splits_everywhere()));
  }
  std::vector<Ray> rays() const {
    std::mt19937 random(3);
    std::vector<Ray> rays(test::reduced(1000));
    for (Ray& ray : rays) {
      ray = {.origin = uniform_point(random, 10.0f), .direction = uniform_point(random, 1.0f)};
      ray.direction = ray.direction - 0.2f * ray.origin;
      if (random() % 4 == 0) ray.t_max = 1.0f;
    }
    return rays;
  }
};

bool passes(const SceneHit& hit) {
  return (hit.primitive + hit.instance) % 3 == 0;
}

TEST_F(SceneFiltered, AFilteredRayHitsTheFirstOfAllHitsThatPasses) {
  kerf_tests::for_each_target([&](const Target&) {
    const Scene scene = this->scene();
    const std::vector<kerf_tests::Leaf> leaves = kerf_tests::leaves_of(scene);
    std::size_t hits = 0;
    for (const Ray& ray : rays()) {
      for (const Mask mask : {Mask{}, Mask{1}, Mask{0}}) {
        SceneHit expected;
        scene.all_hits(ray, [&](const SceneHit& hit) {
          if (!passes(hit) || !leaves[hit.instance].is_seen(mask)) return true;
          expected = hit;
          return false;
        });
        ASSERT_EQ(scene.intersect(ray, mask, passes).value_or(SceneHit{}), expected);
        ASSERT_EQ(scene.occluded(ray, mask, passes), bool(expected));
        hits += bool(expected);
        if (mask == Mask{}) {
          ASSERT_EQ(scene.intersect(ray, passes).value_or(SceneHit{}), expected);
          ASSERT_EQ(scene.occluded(ray, passes), bool(expected));
        }
      }
    }
    EXPECT_GT(hits, test::reduced(100));
  });
}

// Instances with no bit in their mask are seen by rays without a mask alone.
TEST_F(SceneFiltered, EachTriangleOfEachInstanceIsAskedAboutOnce) {
  const Scene scene = this->scene();
  const std::vector<kerf_tests::Leaf> leaves = kerf_tests::leaves_of(scene);
  std::size_t asked = 0;
  for (const Ray& ray : rays()) {
    std::set<std::tuple<std::uint32_t, std::uint32_t, float>> seen;
    std::size_t calls = 0;
    const auto refuse = [&](const SceneHit& hit) {
      seen.emplace(hit.instance, hit.primitive, hit.t);
      ++calls;
      return false;
    };
    EXPECT_FALSE(scene.intersect(ray, refuse));
    ASSERT_EQ(calls, seen.size());
    std::set<std::tuple<std::uint32_t, std::uint32_t, float>> all;
    scene.all_hits(ray, [&](const SceneHit& hit) {
      if (leaves[hit.instance].is_seen({})) all.emplace(hit.instance, hit.primitive, hit.t);
    });
    ASSERT_EQ(seen, all);
    calls = 0;
    EXPECT_FALSE(scene.occluded(ray, refuse));
    ASSERT_EQ(calls, all.size());
    asked += calls;
  }
  EXPECT_GT(asked, test::reduced(500));
}

// Of what is not nearer than the closest hit so far, nothing is asked.
TEST_F(SceneFiltered, AFilterIsAskedOfNearerHitsOnly) {
  const Scene scene = this->scene();
  for (const Ray& ray : rays()) {
    SceneHit last;
    const auto hit = scene.intersect(ray, [&](const SceneHit& each) {
      EXPECT_TRUE(each.t < last.t || (each.t == last.t && each.instance <= last.instance));
      last = each;
      return true;
    });
    ASSERT_EQ(hit, scene.intersect(ray, Mask{}));
    if (hit) {
      ASSERT_EQ(last, *hit);
    }
  }
}

TEST_F(SceneFiltered, ManyRaysHaveTheirOwnAnswers) {
  const Scene scene = this->scene();
  const std::vector<Ray> rays = this->rays();
  const auto filter = [](std::size_t ray, const SceneHit& hit) { return (ray + hit.primitive) % 2 == 0; };
  std::vector<SceneHit> hits(rays.size());
  std::vector<char> occluded(rays.size());
  std::vector<std::uint32_t> masks(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) masks[i] = static_cast<std::uint32_t>(i % 5);
  RayView view = rays;
  for (const bool masked : {false, true}) {
    if (masked) view.mask = {masks.data()};
    scene.intersect(view, hits, filter);
    scene.occluded(view, occluded, filter, {.threads = 1});
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Mask mask = masked ? Mask{masks[i]} : Mask{};
      const auto expected =
          scene.intersect(rays[i], mask, [&](const SceneHit& hit) { return filter(i, hit); });
      ASSERT_EQ(hits[i], expected.value_or(SceneHit{}));
      ASSERT_EQ(occluded[i] != 0, expected.has_value());
    }
  }
  hits.pop_back();
  EXPECT_THROW(scene.intersect(view, hits, filter), Error);
}

TEST_F(SceneFiltered, AFilterMayThrow) {
  const Scene scene = this->scene();
  const auto refuse = [](const SceneHit&) -> bool { throw std::runtime_error("no"); };
  std::size_t thrown = 0;
  for (const Ray& ray : rays()) {
    if (!scene.occluded(ray, Mask{})) continue;
    ++thrown;
    EXPECT_THROW(scene.intersect(ray, refuse), std::runtime_error);
    EXPECT_THROW(scene.occluded(ray, refuse), std::runtime_error);
  }
  EXPECT_GT(thrown, 0u);
}

}  // namespace
}  // namespace kerf
