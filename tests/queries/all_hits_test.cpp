// The contract of `all_hits` apart from which triangles are crossed: order, multiplicity, early stop and
// parity.
#include <algorithm>
#include <functional>
#include <new>

#include <gtest/gtest.h>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;
using workbench::Solid;

std::vector<Hit> gather(const Bvh& bvh, const Ray& ray) {
  std::vector<Hit> hits;
  bvh.all_hits(ray, [&](const Hit& hit) { hits.push_back(hit); });
  return hits;
}

TEST(AllHits, VisitsCopiesOfOneTriangleEachOnceInOrder) {
  const Soup copies(std::vector<Triangle>(100000, Triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}));
  const Bvh bvh = build(copies.mesh());
  const std::vector<Hit> hits = gather(bvh, {.origin = {1, 1, 5}, .direction = {0, 0, -1}});
  ASSERT_EQ(hits.size(), 100000u);
  for (std::uint32_t i = 0; i < hits.size(); ++i) {
    ASSERT_EQ(hits[i], (Hit{.t = 5.0f, .u = 0.25f, .v = 0.25f, .primitive = i, .mesh = 0}));
  }
}

TEST(AllHits, ManyHitsAreListedInOrderWhereverTheyLie) {
  // On both sides of the numbers from which lists are sorted by digits; t and numbers in no order.
  std::mt19937 random(1);
  for (const std::size_t count : {1000u, 3000u}) {
    std::vector<Triangle> layers;
    for (std::size_t i = 0; i < count; ++i) {
      const float z = static_cast<float>(random() % 700) / 8.0f;
      layers.push_back({{-4, -4, z}, {8, -4, z}, {-4, 8, z}});
    }
    const Bvh bvh = build(Soup(layers).mesh());
    const Ray ray{.origin = {0.1f, 0.2f, -1}, .direction = {0, 0, 2}};
    std::vector<Hit> hits(count);
    ASSERT_EQ(bvh.all_hits(ray, hits), count);
    EXPECT_EQ(bvh.count_hits(ray), count);
    for (std::size_t i = 1; i < count; ++i) {
      ASSERT_TRUE(hits[i - 1].t < hits[i].t ||
                  (hits[i - 1].t == hits[i].t && hits[i - 1].primitive < hits[i].primitive));
    }
    EXPECT_EQ(gather(bvh, ray), hits);
  }
}

TEST(AllHits, StopsWhenTheVisitorSaysSo) {
  const Bvh bvh = build(workbench::make_sphere(3).mesh());
  const Ray ray{.origin = {0.1f, 0.2f, 5}, .direction = {0, 0, -1}};
  int visits = 0;
  bvh.all_hits(ray, [&](const Hit&) {
    ++visits;
    return false;
  });
  EXPECT_EQ(visits, 1);
  EXPECT_EQ(gather(bvh, ray).size(), 2u);
}

bool take_none(const Hit&) {
  return false;
}

TEST(AllHits, VisitorsMayBeConstantsAndFunctions) {
  const Bvh bvh = build(workbench::make_sphere(3).mesh());
  const Ray ray{.origin = {0.1f, 0.2f, 5}, .direction = {0, 0, -1}};
  int visits = 0;
  const auto count = [&](const Hit&) { ++visits; };
  bvh.all_hits(ray, count);
  const std::function<void(const Hit&)> wrapped = count;
  bvh.all_hits(ray, wrapped);
  bvh.all_hits(ray, take_none);
  bvh.all_hits(ray, &take_none);
  EXPECT_EQ(visits, 4);
}

TEST(AllHits, WhatTheVisitorThrowsComesThroughAsItIs) {
  const Bvh bvh = build(workbench::make_sphere(3).mesh());
  const Ray ray{.origin = {0.1f, 0.2f, 5}, .direction = {0, 0, -1}};
  EXPECT_THROW(bvh.all_hits(ray, [](const Hit&) { throw 42; }), int);
  EXPECT_THROW(bvh.all_hits(ray, [](const Hit&) { throw std::bad_alloc(); }), std::bad_alloc);
}

TEST(AllHits, TheSpanFormFillsWhatThereIsRoomForAndCountsTheRest) {
  const Bvh bvh = build(workbench::make_torus(32, 16).mesh());
  const Ray ray{.origin = {5, 0.01f, 0.02f}, .direction = {-1, 0, 0}};
  const std::vector<Hit> all = gather(bvh, ray);
  ASSERT_EQ(all.size(), 4u);
  std::vector<Hit> some(3);
  EXPECT_EQ(bvh.all_hits(ray, some), 4u);
  EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin()));
  EXPECT_EQ(bvh.all_hits(ray, std::span<Hit>()), 4u);
}

TEST(AllHits, NamesMeshesAndPrimitives) {
  const Solid near = workbench::make_box({-1, -1, 2}, {1, 1, 3}),
              far = workbench::make_box({-1, -1, -3}, {1, 1, -2});
  const TriangleMesh meshes[] = {far.mesh(), near.mesh()};
  const Bvh bvh = build(meshes);
  const std::vector<Hit> hits = gather(bvh, {.origin = {0.3f, 0.1f, 9}, .direction = {0, 0, -1}});
  ASSERT_EQ(hits.size(), 4u);
  EXPECT_EQ(hits[0].mesh, 1u);
  EXPECT_EQ(hits[1].mesh, 1u);
  EXPECT_EQ(hits[2].mesh, 0u);
  EXPECT_EQ(hits[3].mesh, 0u);
  for (const Hit& hit : hits) EXPECT_LT(hit.primitive, 12u);
}

TEST(AllHits, ANonsenseRayOrAnEmptyTreeHasNone) {
  const Bvh bvh = build(workbench::make_box({-1, -1, -1}, {1, 1, 1}).mesh());
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(gather(bvh, {.origin = {0, 0, 0}, .direction = {0, 0, 0}}).empty());
  EXPECT_TRUE(gather(bvh, {.origin = {nan, 0, 0}, .direction = {1, 0, 0}}).empty());
  EXPECT_TRUE(gather(bvh, {.origin = {0, 0, 0}, .direction = {infinity, 0, 0}}).empty());
  EXPECT_TRUE(gather(bvh, {.origin = {0, 0, 0}, .direction = {1, 0, 0}, .t_min = nan}).empty());
  EXPECT_TRUE(gather(bvh, {.origin = {0, 0, 0}, .direction = {1, 0, 0}, .t_min = 2, .t_max = 1}).empty());
  EXPECT_TRUE(gather(Bvh(), {.origin = {0, 0, 0}, .direction = {1, 0, 0}}).empty());
}

TEST(AllHits, AreThoseOfALineIfTheRayHasNoEnds) {
  const Bvh bvh = build(workbench::make_box({-1, -1, -1}, {1, 1, 1}).mesh());
  const float infinity = std::numeric_limits<float>::infinity();
  Ray ray{.origin = {0.3f, 0.1f, 0}, .direction = {0, 0, 1}, .t_min = -infinity};
  const std::vector<Hit> hits = gather(bvh, ray);
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_EQ(hits[0].t, -1.0f);
  EXPECT_EQ(hits[1].t, 1.0f);
  ray.t_min = -9, ray.t_max = -0.5f;
  EXPECT_EQ(gather(bvh, ray).size(), 1u);
}

// An odd number from inside, an even one from outside, whatever the ray is aimed at.
TEST(AllHits, HasTheRightParityThroughEveryVertexAndEdge) {
  for (const Solid& solid : {workbench::make_sphere(3), workbench::make_box({-2, -2, -2}, {2, 2, 2}, 4),
                             workbench::make_torus(24, 12, 2.0f, 0.5f)}) {
    const Bvh bvh = build(solid.mesh(), spatial_splits_everywhere());
    const bool torus = solid.triangles.size() == 2u * 24 * 12;
    const Vec3f inside = torus ? Vec3f{2, 0, 0} : Vec3f{0, 0, 0};
    const Vec3f outside{8, 8, 8};
    for (const auto& triangle : solid.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3f a = solid.vertices[triangle[i]], b = solid.vertices[triangle[(i + 1) % 3]];
        for (const Vec3f at : {a, 0.5f * (a + b), 0.25f * a + 0.75f * b}) {
          ASSERT_EQ(gather(bvh, {.origin = inside, .direction = at - inside}).size() % 2, 1u);
          ASSERT_EQ(gather(bvh, {.origin = outside, .direction = at - outside}).size() % 2, 0u);
        }
      }
    }
  }
}

}  // namespace
}  // namespace kerf
