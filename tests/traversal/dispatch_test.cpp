#include "traversal/dispatch.hpp"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "structure.hpp"
#include "support/adversarial.hpp"
#include "support/random_scenes.hpp"
#include "support/targets.hpp"

namespace {

// The instruction set that `name` makes a hierarchy use.
std::string target_for(const char* name, const kerf::TriangleMesh& mesh) {
  const kerf_tests::ChosenTarget chosen(name);
  return std::string(kerf::instruction_set(kerf::build(mesh)));
}

}  // namespace

TEST(Dispatch, EveryInstructionSetGivesTheSameHits) {
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

// On a grid, rays run through edges and vertices, and points lie on surfaces.
TEST(Dispatch, EveryInstructionSetGivesTheSameAnswersToQueries) {
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

TEST(Dispatch, KernelsAreThoseOfTheTargetThatTheEnvironmentNames) {
  std::mt19937 random(10);
  const TriangleSoup soup = random_soup(random, 10, 0.3f, 0.2f);
  for (const kerf::Target& target : kerf::supported_targets())
    EXPECT_EQ(target_for(target.name, soup.mesh()), target.name);
  EXPECT_THROW(target_for("none such", soup.mesh()), kerf::Error);
  EXPECT_EQ(target_for("", soup.mesh()), kerf::supported_targets().front().name);
}
