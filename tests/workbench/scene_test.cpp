#include <cmath>
#include <tuple>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "support/temporary_directory.hpp"
#include "workbench/base/vectors.hpp"
#include "workbench/generate/generated_scenes.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/rays/camera.hpp"
#include "workbench/scene/viewpoints.hpp"

namespace workbench {
namespace {

using namespace kerf;

TEST(GeneratedScenes, HaveTheTriangleCountsThatAreListed) {
  for (const GeneratedScene& generated : generated_scenes()) {
    SCOPED_TRACE(generated.name);
    const Scene scene = generated.generate(1.0);
    EXPECT_EQ(scene.triangles.size(), generated.default_triangles);
    EXPECT_GE(scene.triangles.size(), 50'000u);
    EXPECT_LE(scene.triangles.size(), 300'000u);
    EXPECT_GE(scene.viewpoints.size(), 3u);
  }
}

TEST(GeneratedScenes, AreTheSameEveryTimeAndValid) {
  for (const GeneratedScene& generated : generated_scenes()) {
    SCOPED_TRACE(generated.name);
    const Scene first = generated.generate(0.05), second = generated.generate(0.05);
    EXPECT_EQ(first.vertices, second.vertices);
    EXPECT_EQ(first.triangles, second.triangles);
    for (const Vec3f& vertex : first.vertices) ASSERT_TRUE(is_finite(vertex));
    for (const auto& triangle : first.triangles) {
      for (const std::uint32_t vertex : triangle) ASSERT_LT(vertex, first.vertices.size());
    }
  }
}

TEST(GeneratedScenes, GrowWithDetail) {
  for (const GeneratedScene& generated : generated_scenes()) {
    SCOPED_TRACE(generated.name);
    const auto once = static_cast<double>(generated.default_triangles);
    const auto threefold = static_cast<double>(generated.generate(3.0).triangles.size());
    const auto hundredth = static_cast<double>(generated.generate(0.01).triangles.size());
    EXPECT_GT(threefold, 1.9 * once);
    EXPECT_LT(threefold, 4.0 * once);
    EXPECT_LT(hundredth, 0.25 * once);
    EXPECT_GT(hundredth, 0.0);
  }
}

// Positions of vertices, hashed bit by bit: what another machine, compiler or library must give as well.
TEST(GeneratedScenes, AreTheSameOnEveryMachine) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
  for (const GeneratedScene& generated : generated_scenes()) {
    for (const Vec3f& vertex : generated.generate(0.02).vertices) {
      for (int axis = 0; axis < 3; ++axis)
        hash = (hash ^ std::bit_cast<std::uint32_t>(vertex[axis])) * 0x100000001b3u;
    }
  }
  EXPECT_EQ(hash, 1725888714449570221u);
}

TEST(GeneratedScenes, FillTheViewFromEveryViewpoint) {
  constexpr std::size_t side = 24;
  for (const GeneratedScene& generated : generated_scenes()) {
    const Scene scene = generated.generate(1.0);
    const Bvh bvh = build(scene.mesh(), {.builder = Builder::bvh, .progress = {}});
    const float diagonal = length(extent(bvh.bounds()));
    for (std::size_t i = 0; i < scene.viewpoints.size(); ++i) {
      SCOPED_TRACE(std::string(generated.name) + ", viewpoint " + std::to_string(i));
      const Camera camera(scene.viewpoints[i], side, side);
      int hits = 0, close = 0;
      for (std::size_t y = 0; y < side; ++y) {
        for (std::size_t x = 0; x < side; ++x) {
          const auto hit =
              bvh.intersect(camera.ray_through(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
          hits += hit.has_value();
          close += hit && hit->t < 0.005f * diagonal;
        }
      }
      EXPECT_GT(hits, static_cast<int>(side * side) / 4);
      EXPECT_LT(close, static_cast<int>(side * side) / 10);  // nothing stands right before the camera
    }
  }
}

TEST(LoadScene, KeepsTheNameAsWritten) {
  EXPECT_EQ(load_scene("sticks:detail=0.01").name, "sticks:detail=0.01");
}

TEST(LoadScene, RotatesAboutZThenYThenXAndTheViewpointsWithIt) {
  const Scene still = load_scene("sticks:detail=0.01"), turned = load_scene("sticks:rotate=90,detail=0.01");
  // A right angle about z, y and x in turn takes (x, y, z) to (-y, x, z), to (z, x, y), to (z, -y, x).
  const auto turn = [](const Vec3f& p) { return Vec3f{p.z, -p.y, p.x}; };
  ASSERT_EQ(still.vertices.size(), turned.vertices.size());
  for (std::size_t i = 0; i < still.vertices.size(); ++i)
    ASSERT_EQ(turned.vertices[i], turn(still.vertices[i]));
  for (std::size_t i = 0; i < still.viewpoints.size(); ++i) {
    EXPECT_EQ(turned.viewpoints[i].position, turn(still.viewpoints[i].position));
    EXPECT_EQ(turned.viewpoints[i].target, turn(still.viewpoints[i].target));
    EXPECT_EQ(turned.viewpoints[i].up, turn(still.viewpoints[i].up));
  }
}

TEST(LoadScene, ReadsFilesWithColonsInTheirNames) {
  const TemporaryDirectory directory;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const std::string_view name : {"a:b.obj", "a:rotate=1.obj"}) {
    const std::string file = directory.write(name, triangle);
    EXPECT_EQ(load_scene(file).triangles.size(), 1u);
    EXPECT_NE(load_scene(file + ":rotate=30").vertices, load_scene(file).vertices);
  }
}

TEST(LoadScene, NamesWhatIsWrongWithTheOptions) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const auto& [spec, cause] : {std::pair<std::string, std::string>{"sticks:turn=30", "turn"},
                                    {"sticks:rotate=far", "far"},
                                    {"sticks:rotate", "rotate"},
                                    {"sticks:rotate=nan", "nan"},
                                    {"sticks:detail=-1", "detail"},
                                    {"sticks:detail=0", "detail"},
                                    {"sticks:detail=1,,rotate=3", "unknown option ''"},
                                    {file + ":detail=2", "detail"},
                                    {file + ":shine=2", "shine"},
                                    {"no_such_scene", "no_such_scene"},
                                    {"no_such_scene:rotate=3", "no_such_scene"}}) {
    SCOPED_TRACE(spec);
    try {
      load_scene(spec);
      ADD_FAILURE() << "was loaded";
    } catch (const Error& error) {
      EXPECT_NE(std::string_view(error.what()).find(cause), std::string_view::npos) << error.what();
    }
  }
}

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

}  // namespace
}  // namespace workbench
