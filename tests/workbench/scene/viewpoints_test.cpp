#include "workbench/scene/viewpoints.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/rays/camera.hpp"

namespace workbench {
namespace {

using namespace kerf;

TEST(Viewpoints, AreThreeInsideAndThreeOutside) {
  const Solid room = make_box({-8, 0, -3}, {8, 4, 3}, 4);
  const std::vector<Viewpoint> viewpoints = choose_viewpoints(room.mesh());
  ASSERT_EQ(viewpoints.size(), 6u);
  const Bvh bvh = build(room.mesh());
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    const Vec3f p = viewpoints[i].position;
    const bool is_inside = std::abs(p.x) < 8 && p.y > 0 && p.y < 4 && std::abs(p.z) < 3;
    EXPECT_EQ(is_inside, i < 3);
    EXPECT_TRUE(bvh.intersect({.origin = p, .direction = viewpoints[i].target - p}).has_value());
  }
  EXPECT_NE(viewpoints[0].position, viewpoints[1].position);
  EXPECT_NE(viewpoints[1].position, viewpoints[2].position);
}

TEST(Viewpoints, CanBeLookedThroughWhateverTheMesh) {
  const std::vector<std::vector<Vec3f>> meshes = {
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},                             // a point
      {{1e9f, 1e9f, 1e9f}, {1e9f, 1e9f, 1e9f}, {1e9f, 1e9f, 1e9f}},  // far away
      {{0, 0, 0}, {1e-9f, 0, 0}, {0, 1e-9f, 0}},
      {{-1e9f, 0, 0}, {1e9f, 0, 0}, {0, 1e9f, 0}},
      {{0, 0, 0}, {0, 5, 0}, {0, 9, 0}}};  // on the vertical
  const std::vector<std::uint32_t> triangle{0, 1, 2};
  for (const auto& vertices : meshes) {
    for (const Viewpoint& viewpoint : choose_viewpoints({.vertices = vertices, .triangles = triangle})) {
      const Ray ray = Camera(viewpoint, 8, 8).ray_through(1, 2);
      EXPECT_TRUE(is_finite(ray.origin));
      EXPECT_TRUE(is_finite(ray.direction));
    }
  }
}
TEST(Viewpoints, NamedOnesShowAllOfTheMeshFromTheirSide) {
  const Solid solid = make_box({-8, 0, -3}, {8, 4, 3}, 2);
  for (const Vec3f& up : {Vec3f{0, 1, 0}, Vec3f{0, 0, 1}, Vec3f{1, 0, 0}, Vec3f{0, -1, 0}}) {
    for (const std::string_view name : view_names) {
      const auto view = named_view(solid.mesh(), name, up, 1.5f);
      ASSERT_TRUE(view.has_value()) << name;
      const Vec3f forward = normalize(view->target - view->position);
      const Vec3f right = normalize(cross(forward, view->up)), above = cross(right, forward);
      const float limit = std::tan(0.5f * view->vertical_field_of_view * 3.14159265f / 180.0f);
      for (const Vec3f& vertex : solid.vertices) {
        const Vec3f way = vertex - view->position;
        EXPECT_LE(std::abs(dot(way, above)), limit * dot(way, forward)) << name;
        EXPECT_LE(std::abs(dot(way, right)), 1.5f * limit * dot(way, forward)) << name;
      }
    }
  }
  const auto along = [&](std::string_view name, const Vec3f& up) {
    const auto view = named_view(solid.mesh(), name, up, 1.0f);
    return normalize(view->target - view->position);
  };
  EXPECT_EQ(along("front", {0, 1, 0}), (Vec3f{0, 0, -1}));
  EXPECT_EQ(along("front", {0, 0, 1}), (Vec3f{0, 1, 0}));
  EXPECT_EQ(along("top", {0, 0, 1}), (Vec3f{0, 0, -1}));
  EXPECT_EQ(along("right", {0, 1, 0}), (Vec3f{-1, 0, 0}));
  EXPECT_EQ(named_view(solid.mesh(), "fornt", {0, 1, 0}, 1.0f), std::nullopt);
}

}  // namespace
}  // namespace workbench
