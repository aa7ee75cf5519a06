#include "workbench/scene/surface.hpp"

#include <gtest/gtest.h>

#include "workbench/generate/solids.hpp"

namespace workbench {
namespace {

Scene scene_of(Solid solid) {
  return {.name = "solid",
          .vertices = std::move(solid.vertices),
          .triangles = std::move(solid.triangles),
          .viewpoints = {}};
}

// Every triangle with three vertices of its own, as files without shared vertices have them.
Scene unshared(const Scene& scene) {
  Scene apart;
  for (const auto& triangle : scene.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t corner : triangle) apart.vertices.push_back(scene.vertices[corner]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

TEST(Surface, OfSolidsIsClosedWhetherVerticesAreSharedOrNot) {
  for (const Solid& solid : {make_sphere(2), make_torus(12, 8), make_box({-1, -2, -3}, {1, 2, 3}, 3)}) {
    for (const Scene& scene : {scene_of(solid), unshared(scene_of(solid))}) {
      const SurfaceFacts facts = surface_facts(scene);
      EXPECT_TRUE(facts.closed()) << facts.open_edges;
      EXPECT_EQ(facts.doubled_triangles, 0u);
    }
  }
}

TEST(Surface, WithoutATriangleHasThreeOpenEdges) {
  Scene scene = scene_of(make_sphere(2));
  scene.triangles.pop_back();
  EXPECT_EQ(surface_facts(scene).open_edges, 3u);
}

TEST(Surface, ATriangleTurnedRoundOpensItsEdges) {
  Scene scene = scene_of(make_sphere(2));
  std::swap(scene.triangles[0][1], scene.triangles[0][2]);
  EXPECT_EQ(surface_facts(scene).open_edges, 3u);
}

TEST(Surface, ATriangleThatStandsTwiceIsDoubledWhateverItsFirstVertex) {
  Scene scene = scene_of(make_sphere(2));
  const auto [a, b, c] = scene.triangles[5];
  scene.triangles.push_back({b, c, a});
  EXPECT_EQ(surface_facts(scene).doubled_triangles, 1u);
}

TEST(Surface, ZerosOfEitherSignAreOnePlace) {
  Scene scene = scene_of(make_box({-1, -1, 0}, {1, 1, 1}, 1));
  scene = unshared(scene);
  for (std::size_t i = 0; i < scene.vertices.size(); i += 2) {
    if (scene.vertices[i].z == 0.0f) scene.vertices[i].z = -0.0f;
  }
  EXPECT_TRUE(surface_facts(scene).closed());
}

}  // namespace
}  // namespace workbench
