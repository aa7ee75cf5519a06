// A .kerf file in place of a scene.
#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/open/load_scene.hpp"

namespace workbench {
namespace {

TEST(LoadHierarchy, AKerfFileHasTheTrianglesThatWereSavedInTheirPlaces) {
  Solid sphere = make_sphere(2);
  const Solid box = make_box({-1, -1, -1}, {1, 1, 1}, 2);
  sphere.triangles[7] = {1, 1, 2};  // degenerate
  const kerf::TriangleMesh meshes[] = {sphere.mesh(), box.mesh()};
  const kerf::Bvh bvh = kerf::build(meshes);
  const TemporaryDirectory directory;
  bvh.save(directory / "two.kerf");

  const Scene scene = load_scene((directory / "two.kerf").string());
  ASSERT_EQ(scene.triangles.size(), sphere.triangles.size() + box.triangles.size());
  EXPECT_GE(scene.viewpoints.size(), 3u);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const bool first = i < sphere.triangles.size();
    const Solid& solid = first ? sphere : box;
    const auto& indices = solid.triangles[first ? i : i - sphere.triangles.size()];
    for (std::size_t k = 0; k < 3 && i != 7; ++k) {
      ASSERT_EQ(scene.vertices[scene.triangles[i][k]], solid.vertices[indices[k]]);
    }
  }
  ASSERT_TRUE(scene.hierarchy.has_value());
  const kerf::Ray ray{.origin = {0.1f, 0.2f, 5}, .direction = {0, 0, -1}};
  auto expected = bvh.intersect(ray);
  ASSERT_TRUE(expected.has_value());
  if (expected->mesh == 1) expected->primitive += static_cast<std::uint32_t>(sphere.triangles.size());
  expected->mesh = 0;
  EXPECT_EQ(scene.hierarchy->intersect(ray), expected);
  EXPECT_EQ(kerf::build(scene.mesh()).statistics().degenerate_triangles, 1u);
  EXPECT_FALSE(load_scene((directory / "two.kerf").string() + ":rotate=30").hierarchy.has_value());
}

TEST(LoadHierarchy, ASceneInAFileIsKeptOrCopied) {
  const Solid sphere = make_sphere(2);
  const kerf::Bvh object = kerf::build(sphere.mesh());
  std::vector<kerf::Instance> row, rows;
  for (int i = 0; i < 3; ++i) {
    row.push_back({.object = object, .transform = {{{1, 0, 0, 4.0 * i}, {0, 2, 0, 0}, {0, 0, 1, 0}}}});
    rows.push_back({.transform = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 8.0 * i}}}});
  }
  for (kerf::Instance& instance : rows) instance.scene = kerf::build(row);
  const TemporaryDirectory directory;
  kerf::build(rows).save(directory / "rows.kerf");
  const std::string file = (directory / "rows.kerf").string();
  const Scene kept = load_scene(file, {}, Repeats::kept), copied = load_scene(file);
  ASSERT_TRUE(kept.placed);
  EXPECT_EQ(kept.placed->meshes.size(), 1u);
  EXPECT_EQ(kept.placed->places.size(), 9u);
  EXPECT_EQ(kept.triangle_count(), 9 * sphere.triangles.size());
  EXPECT_EQ(copied.triangles.size(), 9 * sphere.triangles.size());
  EXPECT_EQ(kept.viewpoints.size(), copied.viewpoints.size());
  const kerf::Scene scene = build_scene(*kept.placed, build_objects(*kept.placed));
  const kerf::Bvh bvh = kerf::build(copied.mesh());
  for (int i = 0; i < 9; ++i) {
    const kerf::Ray ray{
        .origin = {4.0f * static_cast<float>(i % 3) + 0.1f, 9, 8.0f * static_cast<float>(i / 3)},
        .direction = {0, -1, 0}};
    ASSERT_TRUE(scene.intersect(ray));
    EXPECT_EQ(scene.intersect(ray)->t, bvh.intersect(ray)->t);
    EXPECT_EQ(scene.intersect(ray)->instance, static_cast<std::uint32_t>(i));
  }
  // Turned, the first row stands along another axis.
  const Scene turned = load_scene(file + ":rotate=90", {}, Repeats::kept),
              turned_copies = load_scene(file + ":rotate=90");
  for (std::size_t place = 0; place < 9; ++place) {
    const kerf::Triangle triangle = turned.placed->triangle(place, 5);
    const auto& [a, b, c] = turned_copies.triangles[place * sphere.triangles.size() + 5];
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(triangle.v0[axis], turned_copies.vertices[a][axis], 1e-5);
  }
}

TEST(LoadHierarchy, AnInvalidKerfFileIsNamedInTheError) {
  const TemporaryDirectory directory;
  write_bytes(directory / "bad.kerf", "v 0 0 0\n");
  kerf::Bvh().save(directory / "empty.kerf");
  const auto sentence = [&](const std::string& name) -> std::string {
    try {
      (void)load_scene((directory / name).string());
    } catch (const kerf::Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(sentence("bad.kerf"), (directory / "bad.kerf").string() + ": this is not a .kerf file");
  EXPECT_EQ(sentence("empty.kerf"), (directory / "empty.kerf").string() + ": has no triangles");
  EXPECT_EQ(sentence("missing.kerf"), (directory / "missing.kerf").string() + ": no such file");
}

}  // namespace
}  // namespace workbench
