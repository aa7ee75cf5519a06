#include "traversal/dispatch.hpp"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "stages.hpp"
#include "structure.hpp"
#include "support/adversarial.hpp"
#include "support/random_scenes.hpp"
#include "support/targets.hpp"

namespace {

// The instruction set that `name` makes a hierarchy use.
std::string target_for(const char* name, const kerf::TriangleMesh& mesh) {
  const kerf_tests::ChosenTarget chosen(name);
  return kerf::build(mesh).structure().kernels->target;
}

}  // namespace

TEST(Kernels, EveryInstructionSetGivesTheSameHits) {
  std::mt19937 random(9);
  const TriangleSoup soup = random_soup(random, 2000, 0.3f, 0.2f);
  const kerf::Bvh best = kerf::build(soup.mesh());
  std::vector<kerf::Ray> rays;
  for (int i = 0; i < 5000; ++i) {
    rays.push_back({.origin = random_point(random), .direction = random_point(random)});
    if (i % 3 == 0) rays.back().t_max = 0.3f;
  }
  kerf_tests::for_each_target([&](const kerf::Target&) {
    const kerf::Bvh bvh = kerf::build(soup.mesh());
    for (const kerf::Ray& ray : rays) {
      ASSERT_EQ(bvh.intersect(ray), best.intersect(ray));
      ASSERT_EQ(bvh.occluded(ray), best.occluded(ray));
    }
  });
}

// On a grid rays run through edges and vertices and points lie on surfaces.
TEST(Kernels, EveryInstructionSetGivesTheSameAnswersToQueries) {
  std::mt19937 random(19);
  const adversarial::Soup on_grid =
      adversarial::soup(400, [&] { return adversarial::grid_point(random, 3); });
  const TriangleSoup soup = random_soup(random, 2000, 0.3f, 0.2f);
  for (const kerf::TriangleMesh& mesh : {on_grid.mesh(), soup.mesh()}) {
    const kerf::Bvh best = kerf::build(mesh);
    kerf_tests::for_each_target([&](const kerf::Target&) {
      const kerf::Bvh bvh = kerf::build(mesh);
      for (int i = 0; i < 500; ++i) {
        const kerf::Vec3f a = i % 2 ? random_point(random) : adversarial::grid_point(random, 4);
        const kerf::Vec3f b = i % 2 ? random_point(random) : adversarial::grid_point(random, 4);
        const auto hits = [&](const kerf::Bvh& asked) {
          std::vector<kerf::Hit> all;
          asked.all_hits({.origin = a, .direction = b}, [&](const kerf::Hit& hit) { all.push_back(hit); });
          return all;
        };
        ASSERT_EQ(hits(bvh), hits(best));
        ASSERT_EQ(bvh.contains(a), best.contains(a));
        ASSERT_EQ(bvh.triangles_in({min(a, b), max(a, b)}), best.triangles_in({min(a, b), max(a, b)}));
        ASSERT_EQ(bvh.closest_point(a), best.closest_point(a));
        ASSERT_EQ(bvh.within(a, 0.5f), best.within(a, 0.5f));
      }
    });
  }
}

TEST(Kernels, AreThoseOfTheTargetThatTheEnvironmentNames) {
  std::mt19937 random(10);
  const TriangleSoup soup = random_soup(random, 10, 0.3f, 0.2f);
  for (const kerf::Target& target : kerf::supported_targets())
    EXPECT_EQ(target_for(target.name, soup.mesh()), target.name);
  EXPECT_EQ(target_for("none such", soup.mesh()), kerf::supported_targets().front().name);
  EXPECT_EQ(target_for("", soup.mesh()), kerf::supported_targets().front().name);
}

TEST(Kernels, CountingChangesNoHit) {
  std::mt19937 random(11);
  const TriangleSoup soup = random_soup(random, 500, 0.3f, 0.2f);
  const kerf::Bvh bvh = kerf::build(soup.mesh());
  kerf::TraversalCounters counters;
  for (int i = 0; i < 1000; ++i) {
    const kerf::Ray ray{.origin = random_point(random), .direction = random_point(random)};
    ASSERT_EQ(kerf::intersect_counted(bvh, ray, counters), bvh.intersect(ray));
    ASSERT_EQ(kerf::occluded_counted(bvh, ray, counters), bvh.occluded(ray));
  }
  EXPECT_GT(counters.steps, 2000u);
  EXPECT_GE(counters.triangle_tests, counters.leaves);
}

TEST(Kernels, RaysThatKeepTogetherAreHitAsSingleOnes) {
  std::mt19937 random(12);
  struct Scene {
    std::uint32_t triangles;
    float size;
  };
  // The last has too many bytes for rays one after another.
  for (const auto& [triangles, size] : {Scene{3000, 0.05f}, Scene{3000, 0.6f}, Scene{120000, 0.02f}}) {
    TriangleSoup soup = random_soup(random, triangles, size, 0.5f);
    const std::vector<std::uint32_t> once(soup.triangles.begin(), soup.triangles.begin() + 300);
    soup.triangles.insert(soup.triangles.end(), once.begin(), once.end());  // ties
    std::vector<kerf::Ray> rays;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const kerf::Vec3f direction{static_cast<float>(x - 20) / 200.0f, static_cast<float>(y - 40) / 200.0f,
                                    1.0f};
        rays.push_back({.origin = {0.1f, 0.0f, -2.0f}, .direction = direction});
        if (y > 32) rays.back().t_max = 2.0f + 0.01f * static_cast<float>(x);
        if (y > 48) rays.back().origin.x += 0.0001f * static_cast<float>(x);
        if (y > 56) rays.back().t_min = 1.5f;
      }
    }
    rays[100].direction = {};
    rays[200].t_max = -1.0f;
    kerf_tests::for_each_target([&](const kerf::Target&) {
      const kerf::Bvh bvh = kerf::build(soup.mesh());
      std::vector<kerf::Hit> hits(rays.size());
      std::vector<std::uint8_t> occluded(rays.size());
      bvh.intersect(rays, hits);
      bvh.occluded(rays, occluded);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i], bvh.intersect(rays[i]).value_or(kerf::Hit{})) << i;
        ASSERT_EQ(occluded[i] != 0, bvh.occluded(rays[i])) << i;
      }
    });
  }
}
