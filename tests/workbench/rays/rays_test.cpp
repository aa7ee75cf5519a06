#include "workbench/rays/rays.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <variant>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/scene/viewpoints.hpp"

namespace workbench {
namespace {

using namespace kerf;

Scene scene_of(Solid solid) {
  Scene scene{.name = "solid",
              .vertices = std::move(solid.vertices),
              .triangles = std::move(solid.triangles),
              .viewpoints = {}};
  scene.viewpoints = {{.position = {0, 0, 0}, .target = {0.3f, 0.2f, 1}}};
  return scene;
}

TEST(Rays, PrimaryOnesRunThroughPixelsTileAfterTile) {
  const Scene scene = scene_of(make_sphere(2));
  const RaySet set = make_rays(scene, Bvh(), RayType::primary, {.width = 20, .height = 12});
  ASSERT_EQ(set.rays.size(), 240u);
  // The first 64 rays keep within an 8 by 8 corner of the picture: 20 by 12 pixels spread over 60 degrees
  // upright.
  float widest = 1.0f;
  for (std::size_t i = 0; i < 64; ++i)
    widest = std::min(widest, dot(set.rays[0].direction, set.rays[i].direction));
  EXPECT_GT(widest, std::cos(0.02f + std::sqrt(2.0f) * 8.0f / 12.0f * 2.0f * std::tan(3.14159f / 6.0f)));
  EXPECT_FALSE(set.any_hit());
  EXPECT_TRUE(make_rays(scene, build(scene.mesh()), RayType::ao).any_hit());
}

// Where floats hold the copies, it makes no difference to rays that they are not made.
TEST(Rays, ThoseOfPlacedMeshesAreThoseOfTheirCopies) {
  const Solid sphere = make_sphere(2);
  Scene kept = scene_of({}), copied = scene_of({});
  kept.placed.emplace();
  kept.placed->meshes.push_back({sphere.vertices, sphere.triangles});
  for (int i = 0; i < 5; ++i)
    kept.placed->places.push_back({0, {{{2, 0, 0, 4.0 * i}, {0, 0, -1, 0}, {0, 1, 0, 8}}}});
  PlacedMeshes::Mesh flat = flattened(*kept.placed, 1'000'000);
  copied.vertices = std::move(flat.vertices);
  copied.triangles = std::move(flat.triangles);
  kept.viewpoints = copied.viewpoints = choose_viewpoints(copied);
  EXPECT_EQ(choose_viewpoints(kept)[4].position, copied.viewpoints[4].position);
  const kerf::Scene places = build_scene(*kept.placed, build_objects(*kept.placed));
  const Bvh bvh = build(copied.mesh());
  const RaySetOptions size{.width = 64, .height = 48};
  const auto bytes = [](const RaySet& set) { return std::as_bytes(std::span(set.rays)); };
  EXPECT_TRUE(std::ranges::equal(bytes(make_rays(Traced(kept, places), RayType::primary, size)),
                                 bytes(make_rays(copied, bvh, RayType::primary, size))));
  for (const RayType type : {RayType::ao, RayType::diffuse}) {
    const RaySet of_places = make_rays(Traced(kept, places), type, size),
                 of_copies = make_rays(copied, bvh, type, size);
    ASSERT_EQ(of_places.rays.size(), of_copies.rays.size());
    ASSERT_GT(of_places.rays.size(), 1000u);
    std::size_t equal = 0;  // lengths of the reach depend on the box, which is not tight around places
    for (std::size_t i = 0; i < of_places.rays.size(); ++i)
      equal += of_places.rays[i].direction == of_copies.rays[i].direction;
    EXPECT_EQ(equal, of_places.rays.size());
  }
}

TEST(Rays, SecondaryOnesLeaveFromEveryPrimaryHitWithoutHittingItAgain) {
  for (const float scale : {1e-3f, 1.0f, 1e5f}) {
    for (const float shift : {0.0f, 100.0f}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << ", shift " << shift);
      const Vec3f center = (shift * scale) * Vec3f{1, -2, 1};
      Scene scene = scene_of(make_sphere(4, scale, center));
      // From outside: all that leaves a convex body's outside escapes.
      scene.viewpoints = choose_viewpoints(scene.mesh());
      scene.viewpoints.erase(scene.viewpoints.begin(), scene.viewpoints.begin() + 3);
      const Bvh bvh = build(scene.mesh());
      const RaySet primary = make_rays(scene, bvh, RayType::primary, {.width = 64, .height = 48});
      std::size_t hits = 0;
      for (const Ray& ray : primary.rays) hits += bvh.intersect(ray).has_value();
      for (const RayType type : {RayType::ao, RayType::diffuse}) {
        const RaySet set = make_rays(scene, bvh, type, {.width = 64, .height = 48});
        EXPECT_EQ(set.rays.size(), hits);
        for (const Ray& ray : set.rays) ASSERT_FALSE(bvh.occluded(ray));
      }
    }
  }
}

TEST(Rays, SecondaryOnesAreCosineDistributed) {
  const Scene scene = scene_of(make_box({-1, -1, -1}, {1, 1, 1}));
  const Bvh bvh = build(scene.mesh());
  const RaySet set = make_rays(scene, bvh, RayType::diffuse);
  ASSERT_EQ(set.rays.size(), 256u * 192u);
  // The mean of cos is 2/3 and that of cos^2 is 1/2 where the density is proportional to cos. The wall that a
  // ray leaves is across the axis on which its origin is largest, but for rays from near an edge of the box.
  double count = 0.0, sum = 0.0, sum_of_squares = 0.0;
  for (const Ray& ray : set.rays) {
    EXPECT_NEAR(length(ray.direction), 1.0f, 1e-5f);
    int near_walls = 0, axis = 0;
    for (int i = 0; i < 3; ++i) {
      if (std::abs(ray.origin[i]) < 0.999f) continue;
      ++near_walls;
      axis = i;
    }
    if (near_walls != 1) continue;
    const double cosine = ray.direction[axis] * (ray.origin[axis] > 0 ? -1.0 : 1.0);
    ASSERT_GE(cosine, 0.0);
    ++count;
    sum += cosine;
    sum_of_squares += cosine * cosine;
  }
  EXPECT_GT(count, 0.98 * static_cast<double>(set.rays.size()));
  EXPECT_NEAR(sum / count, 2.0 / 3.0, 0.005);
  EXPECT_NEAR(sum_of_squares / count, 0.5, 0.005);
}

TEST(Rays, AmbientOcclusionReachesAQuarterOfTheDiagonal) {
  const Scene scene = scene_of(make_box({-1, -2, -2}, {1, 2, 2}));
  const Bvh bvh = build(scene.mesh());
  for (const Ray& ray : make_rays(scene, bvh, RayType::ao).rays) ASSERT_FLOAT_EQ(ray.t_max, 0.25f * 6.0f);
  for (const Ray& ray : make_rays(scene, bvh, RayType::diffuse).rays) ASSERT_TRUE(std::isinf(ray.t_max));
}

TEST(Rays, MadeOneAtATimeAreTheSameBitByBit) {
  Scene scene = scene_of(make_torus(64, 32));
  scene.viewpoints = choose_viewpoints(scene.mesh());
  const Bvh bvh = build(scene.mesh());
  const auto bits = [](const Ray& ray) { return std::bit_cast<std::array<std::uint32_t, 8>>(ray); };
  for (const RayType type : ray_types) {
    const RaySet set = make_rays(scene, bvh, type, {.width = 64, .height = 48});
    ASSERT_GT(set.rays.size(), 1000u);
    std::visit(
        [&](const auto& maker) {
          ASSERT_EQ(maker.samples.size(), set.rays.size());
          for (std::size_t i = 0; i < set.rays.size(); ++i) {
            const MadeRay made = maker.make(i);
            const Ray ray{.origin = made.origin, .direction = made.direction, .t_max = maker.t_max};
            ASSERT_EQ(bits(ray), bits(set.rays[i])) << name(type) << " " << i;
          }
        },
        set.maker);
  }
}

TEST(Rays, AreTheSameForEveryHierarchyOfTheScene) {
  const Scene scene = scene_of(make_torus(64, 32));
  const Bvh first = build(scene.mesh()),
            second = build(scene.mesh(), {.builder = Builder::bvh, .progress = {}});
  for (const RayType type : ray_types) {
    const RaySet a = make_rays(scene, first, type), b = make_rays(scene, second, type);
    ASSERT_EQ(a.rays.size(), b.rays.size());
    for (std::size_t i = 0; i < a.rays.size(); ++i) {
      ASSERT_EQ(a.rays[i].origin, b.rays[i].origin);
      ASSERT_EQ(a.rays[i].direction, b.rays[i].direction);
    }
  }
}
TEST(Rays, AreFewerWhereEachTestsEveryTriangle) {
  const Scene plain = scene_of(make_sphere(3));
  const RaySetOptions asked{.width = 64, .height = 48};
  EXPECT_EQ(affordable(plain, build(plain.mesh()), asked), asked) << "a sphere is no burden";
  Scene heaped = scene_of(make_sphere(0));
  const auto once = heaped.triangles;
  for (int i = 0; i < 100; ++i) heaped.triangles.insert(heaped.triangles.end(), once.begin(), once.end());
  const Bvh bvh = build(heaped.mesh());
  const RaySetOptions given = affordable(heaped, bvh, asked, 100'000);
  EXPECT_LT(given.width * given.height, asked.width * asked.height);
  EXPECT_GE(given.width, 8u);
  EXPECT_EQ(affordable(heaped, bvh, asked, 100'000), given) << "it counts and does not time";
}
TEST(Rays, AreSharedByTheHierarchiesThatTraceThemWhereOneAloneTakesTooMuch) {
  const RaySetOptions asked{.width = 64, .height = 48};
  const Scene plain = scene_of(make_sphere(3));
  EXPECT_EQ(affordable(plain, build(plain.mesh()), asked, max_visits_of_a_pass, 1000), asked)
      << "what is no burden for one is traced by all";
  Scene heaped = scene_of(make_sphere(0));
  const auto once = heaped.triangles;
  for (int i = 0; i < 100; ++i) heaped.triangles.insert(heaped.triangles.end(), once.begin(), once.end());
  const Bvh bvh = build(heaped.mesh());
  for (const std::size_t hierarchies : {1u, 2u, 9u}) {
    const RaySetOptions given = affordable(heaped, bvh, asked, 1'000'000, hierarchies);
    const RaySet set = make_rays(heaped, bvh, RayType::primary, given);
    const double visits =
        visits_per_ray(bvh, set.rays, max_visits_of_a_pass) * static_cast<double>(set.rays.size());
    EXPECT_LE(visits * static_cast<double>(hierarchies), 1.5e6) << hierarchies;
  }
}
TEST(Rays, AreFewerStillWhereEachMeetsEveryTriangleAtTheSameDistance) {
  constexpr int count = 64;
  Scene equal{.name = "heap", .vertices = {}, .triangles = {}, .viewpoints = {}}, layered = equal;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(3 * i);
    for (Scene* scene : {&equal, &layered}) {
      const float z = scene == &equal ? 1.0f : 1.0f + 1e-3f * static_cast<float>(i);
      scene->vertices.insert(scene->vertices.end(), {{-9, -9, z}, {9, -9, z}, {0, 18, z}});
      scene->triangles.push_back({first, first + 1, first + 2});
    }
  }
  equal.viewpoints = layered.viewpoints = {{.position = {0, 0, 0}, .target = {0, 0, 1}, .up = {0, 1, 0}}};
  const RaySetOptions asked{.width = 64, .height = 48};
  const auto given = [&](const Scene& scene) {
    const RaySetOptions pixels = affordable(scene, build(scene.mesh()), asked, 400'000);
    return pixels.width * pixels.height;
  };
  EXPECT_EQ(given(layered), asked.width * asked.height);
  EXPECT_LT(given(equal), asked.width * asked.height);
}

}  // namespace
}  // namespace workbench
