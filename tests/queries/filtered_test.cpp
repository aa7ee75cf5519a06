// Filters and masks of rays: against hierarchies that hold just what passes them.
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/random_scenes.hpp"
#include "support/targets.hpp"

namespace kerf {
namespace {

std::vector<Ray> random_rays(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray = {.origin = adversarial::uniform_point(random, 1.5f),
           .direction = adversarial::uniform_point(random, 1.0f)};
    if (random() % 4 == 0) ray.t_max = 0.7f;
    if (random() % 4 == 0) ray.t_min = random() % 2 == 0 ? 0.3f : -0.6f;
    if (random() % 8 == 0) ray.direction = 1e9f * ray.direction;  // has to be scaled
  }
  return rays;
}

// Small triangles and a few large ones among them, which stand in many leaves.
TriangleSoup small_and_large(std::mt19937& random) {
  TriangleSoup soup = random_soup(random, 1200, 0.1f, 0.7f);
  const TriangleSoup large = random_soup(random, 60, 1.5f, 0.5f);
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  soup.vertices.insert(soup.vertices.end(), large.vertices.begin(), large.vertices.end());
  for (const std::uint32_t vertex : large.triangles) soup.triangles.push_back(first + vertex);
  return soup;
}

struct Filtered : testing::Test {
  std::mt19937 random{7};
  TriangleSoup soup = small_and_large(random);
  std::vector<Ray> rays = random_rays(2000, 8);

  static bool passes(const Hit& hit) { return hit.primitive % 3 == 0; }

  // Of the triangles that pass alone; hits name triangle i of it as 3 * i.
  Bvh passing() const {
    std::vector<std::uint32_t> triangles;
    for (std::size_t i = 0; i < soup.triangles.size(); i += 9)
      triangles.insert(triangles.end(), soup.triangles.begin() + static_cast<std::ptrdiff_t>(i),
                       soup.triangles.begin() + static_cast<std::ptrdiff_t>(i) + 3);
    return build({.vertices = soup.vertices, .triangles = triangles});
  }
};

TEST_F(Filtered, AFilteredRayHitsWhatARayHitsInASceneWithoutTheRest) {
  kerf_tests::for_each_target([&](const Target&) {
    const Bvh bvh = build(soup.mesh(), spatial_splits_everywhere()), expected = passing();
    ASSERT_GT(bvh.statistics().references, bvh.statistics().triangles);
    int hits = 0;
    for (const Ray& ray : rays) {
      auto hit = expected.intersect(ray);
      if (hit) hit->primitive *= 3;
      hits += hit.has_value();
      ASSERT_EQ(bvh.intersect(ray, passes), hit);
      ASSERT_EQ(bvh.occluded(ray, passes), hit.has_value());
    }
    EXPECT_GT(hits, 100);
  });
}

TEST_F(Filtered, EachTriangleIsAskedAboutOnceThoughItStandsInManyLeaves) {
  kerf_tests::for_each_target([&](const Target&) {
    const Bvh bvh = build(soup.mesh(), spatial_splits_everywhere());
    std::size_t asked = 0;
    for (const Ray& ray : rays) {
      std::vector<std::uint32_t> ids;
      const auto refuse = [&](const Hit& hit) {
        ids.push_back(hit.primitive);
        return false;
      };
      EXPECT_FALSE(bvh.intersect(ray, refuse));
      const std::size_t count = ids.size();
      std::sort(ids.begin(), ids.end());
      ASSERT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
      ids.clear();
      EXPECT_FALSE(bvh.occluded(ray, refuse));
      ASSERT_EQ(ids.size(), count);
      std::sort(ids.begin(), ids.end());
      ASSERT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
      asked += count;
    }
    EXPECT_GT(asked, 500u);
  });
}

TEST_F(Filtered, AFilterIsToldTheHitThatTheRayWouldHave) {
  const Bvh bvh = build(soup.mesh(), spatial_splits_everywhere());
  for (const Ray& ray : rays) {
    std::vector<Hit> asked;
    const auto hit = bvh.intersect(ray, [&](const Hit& each) {
      asked.push_back(each);
      return true;
    });
    EXPECT_EQ(hit, bvh.intersect(ray));
    if (hit) {
      EXPECT_NE(std::find(asked.begin(), asked.end(), *hit), asked.end());
    }
  }
}

TEST_F(Filtered, AFilterMayHaveAStateAndThrow) {
  const Bvh bvh = build(soup.mesh());
  const Ray ray{.origin = {0, 0, -3}, .direction = {0, 0, 1}};
  struct Counter {
    int calls = 0;
    bool operator()(const Hit&) { return ++calls > 1000; }
  } counter;
  EXPECT_FALSE(bvh.intersect(ray, counter));
  EXPECT_GT(counter.calls, 0);
  EXPECT_THROW(bvh.occluded(ray, [](const Hit&) -> bool { throw std::runtime_error("no"); }),
               std::runtime_error);
}

TEST_F(Filtered, ARaySeesTheMeshesThatShareABitWithItsMask) {
  std::vector<TriangleMesh> meshes(3, soup.mesh());
  std::mt19937 other_random(9);
  const TriangleSoup other = random_soup(other_random, 300, 0.8f, 0.5f),
                     third = random_soup(other_random, 300, 0.8f, 0.5f);
  meshes[1] = other.mesh();
  meshes[2] = third.mesh();
  meshes[0].mask = {0b001};
  meshes[1].mask = {0b110};
  meshes[2].mask = {};
  const auto visible = [&](std::uint32_t mesh, Mask mask) {
    return (meshes[mesh].mask.bits & mask.bits) != 0;
  };
  kerf_tests::for_each_target([&](const Target&) {
    const Bvh bvh = build(meshes, spatial_splits_everywhere());
    for (const Mask mask : {Mask{0}, Mask{1}, Mask{2}, Mask{0b100}, Mask{8}, Mask{}}) {
      std::vector<TriangleMesh> seen;
      std::vector<std::uint32_t> numbers;
      for (std::uint32_t mesh = 0; mesh < 3; ++mesh) {
        if (!visible(mesh, mask)) continue;
        seen.push_back(meshes[mesh]);
        numbers.push_back(mesh);
      }
      const Bvh expected = build(seen);
      for (std::size_t i = 0; i < rays.size(); i += 3) {
        auto hit = expected.intersect(rays[i]);
        if (hit) hit->mesh = numbers[hit->mesh];
        ASSERT_EQ(bvh.intersect(rays[i], mask), hit);
        ASSERT_EQ(bvh.occluded(rays[i], mask), hit.has_value());
        const auto even = [](const Hit& each) { return each.primitive % 2 == 0; };
        const auto both = bvh.intersect(rays[i], mask, even);
        ASSERT_EQ(both, bvh.intersect(rays[i], [&](const Hit& each) {
          return visible(each.mesh, mask) && even(each);
        }));
        ASSERT_EQ(bvh.occluded(rays[i], mask, even), both.has_value());
      }
    }
  });
}

TEST_F(Filtered, ManyRaysAreFilteredAndMaskedAsEachOfThem) {
  std::vector<TriangleMesh> meshes(2, soup.mesh());
  const TriangleSoup other = random_soup(random, 300, 0.8f, 0.5f);
  meshes[0].mask = {1};
  meshes[1] = other.mesh();
  meshes[1].mask = {2};
  const Bvh bvh = build(meshes, spatial_splits_everywhere());
  std::vector<std::uint32_t> masks(rays.size());
  for (std::size_t i = 0; i < masks.size(); ++i) masks[i] = static_cast<std::uint32_t>(i % 4);
  RayView masked = rays;
  masked.mask = {masks.data()};
  const auto filter = [](std::size_t i, const Hit& hit) { return (hit.primitive + i) % 3 != 0; };
  for (const unsigned threads : {1u, 0u}) {
    std::vector<Hit> hits(rays.size()), filtered(rays.size());
    std::vector<std::uint8_t> dark(rays.size()), dark_filtered(rays.size());
    bvh.intersect(masked, hits, {.threads = threads});
    bvh.occluded(masked, dark, {.threads = threads});
    bvh.intersect(masked, filtered, filter, {.threads = threads});
    bvh.occluded(masked, dark_filtered, filter, {.threads = threads});
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Mask mask{masks[i]};
      const auto one = [&](const Hit& hit) { return filter(i, hit); };
      ASSERT_EQ(hits[i], bvh.intersect(rays[i], mask).value_or(Hit{}));
      ASSERT_EQ(dark[i] != 0, bvh.occluded(rays[i], mask));
      ASSERT_EQ(filtered[i], bvh.intersect(rays[i], mask, one).value_or(Hit{}));
      ASSERT_EQ(dark_filtered[i] != 0, bvh.occluded(rays[i], mask, one));
    }
  }
}

TEST_F(Filtered, AHierarchyOfNothingIsNeverAskedAbout) {
  const auto fail = [](const Hit&) -> bool { throw std::runtime_error("asked"); };
  EXPECT_FALSE(Bvh().intersect(rays[0], fail));
  EXPECT_FALSE(Bvh().occluded(rays[0], fail));
}

}  // namespace
}  // namespace kerf
