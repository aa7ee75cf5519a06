// A refit hierarchy against a build of the moved mesh.
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using adversarial::uniform;
using adversarial::uniform_point;

template <class Mesh, class Move>
void move_vertices(Mesh& mesh, const Move& move) {
  for (Vec3f& v : mesh.vertices) v = move(v);
}

// A bend round the z axis, by `angle` per unit of y.
Vec3f bent(const Vec3f& p, float angle) {
  const float c = std::cos(angle * p.y), s = std::sin(angle * p.y);
  return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

// Answers of all kinds, of the two hierarchies to the same questions.
void expect_same_answers(const Bvh& bvh, const Bvh& other, unsigned seed, int questions = 60) {
  std::mt19937 random(seed);
  EXPECT_EQ(bvh.bounds(), other.bounds());
  for (int i = 0; i < questions; ++i) {
    const Vec3f point = uniform_point(random, 1.5f);
    Ray ray{.origin = point, .direction = uniform_point(random, 1.0f)};
    if (i % 3 == 0) ray.direction[i % 2] = 0.0f;
    if (const auto id = static_cast<std::uint32_t>(random() % bvh.statistics().triangles); i % 2 == 0) {
      if (const auto triangle = other.triangle({id, 0})) ray = adversarial::aim(random, *triangle, 3.0f);
    }
    ASSERT_EQ(bvh.intersect(ray), other.intersect(ray));
    ASSERT_EQ(bvh.occluded(ray), other.occluded(ray));
    std::vector<Hit> hits, other_hits;
    bvh.all_hits(ray, [&](const Hit& hit) { hits.push_back(hit); });
    other.all_hits(ray, [&](const Hit& hit) { other_hits.push_back(hit); });
    ASSERT_EQ(hits, other_hits);
    ASSERT_EQ(bvh.count_hits(ray), other_hits.size());
    ASSERT_EQ(bvh.side(point), other.side(point));
    ASSERT_EQ(bvh.closest_point(point), other.closest_point(point));
    ASSERT_EQ(bvh.nearest(point, 5), other.nearest(point, 5));
    ASSERT_EQ(bvh.within(point, 0.4f), other.within(point, 0.4f));
    const Box3f box{point, point + Vec3f{0.3f, 0.3f, 0.3f}};
    ASSERT_EQ(bvh.triangles_in(box), other.triangles_in(box));
    const PrimitiveId id{static_cast<std::uint32_t>(random() % 40), 0};
    const auto triangle = bvh.triangle(id), other_triangle = other.triangle(id);
    ASSERT_EQ(triangle.has_value(), other_triangle.has_value());
    if (triangle) {
      ASSERT_EQ(triangle->v0, other_triangle->v0);
      ASSERT_EQ(triangle->v1, other_triangle->v1);
      ASSERT_EQ(triangle->v2, other_triangle->v2);
    }
  }
  EXPECT_EQ(bvh.statistics().degenerate_triangles, other.statistics().degenerate_triangles);
  EXPECT_EQ(bvh.statistics().non_finite_triangles, other.statistics().non_finite_triangles);
}

TEST(Refit, AnswersAreThoseOfABuildOfTheMovedMesh) {
  kerf_tests::for_each_target([](const Target&) {
    kerf_tests::Mesh mesh = kerf_tests::large_among_small(600);
    Bvh bvh = build(mesh.mesh(), spatial_splits_everywhere());
    EXPECT_GT(bvh.statistics().references, 620u);
    std::mt19937 random(7);
    for (unsigned frame = 0; frame < 5; ++frame) {
      // Small motions, a wild one, and back into the unit cube.
      const float size = frame == 3 ? 1.0f : 0.03f;
      move_vertices(mesh, [&](const Vec3f& v) { return v + uniform_point(random, size); });
      if (frame == 4) move_vertices(mesh, [](const Vec3f& v) { return bent(v, 2.0f); });
      EXPECT_FALSE(refit(bvh, mesh.mesh()).rebuilt);
      expect_same_answers(bvh, build(mesh.mesh()), frame, 20);
    }
  });
}

TEST(Refit, SeveralMeshesKeepTheirNumbersAndMasks) {
  kerf_tests::Mesh a = kerf_tests::large_among_small(60), b = kerf_tests::random_triangles(40, 0.5f, 0.5f, 3);
  const auto meshes = [&] {
    TriangleMesh first = a.mesh(), second = b.mesh();
    second.mask = {2};
    return std::array{first, second};
  };
  Bvh bvh = build(meshes(), spatial_splits_everywhere());
  std::mt19937 random(5);
  move_vertices(a, [&](const Vec3f& v) { return v + uniform_point(random, 0.1f); });
  move_vertices(b, [](const Vec3f& v) { return Vec3f{v.y, v.z, v.x}; });
  refit(bvh, meshes());
  const Bvh other = build(meshes());
  for (int i = 0; i < 200; ++i) {
    const Ray ray{.origin = uniform_point(random, 2.0f), .direction = uniform_point(random, 1.0f)};
    ASSERT_EQ(bvh.intersect(ray), other.intersect(ray));
    ASSERT_EQ(bvh.intersect(ray, Mask{4}), other.intersect(ray, Mask{4}));
  }
}

TEST(Refit, ABentClosedSurfaceStaysWatertight) {
  workbench::Solid sphere = workbench::make_sphere(4);
  Bvh bvh = build(sphere.mesh(), spatial_splits_everywhere());
  move_vertices(sphere, [](const Vec3f& v) { return bent({v.x, 3.0f * v.y, v.z}, 0.2f); });
  refit(bvh, sphere.mesh());
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const auto& [a, b, c] = sphere.triangles[random() % sphere.triangles.size()];
    const Triangle target{sphere.vertices[a], sphere.vertices[b], sphere.vertices[c]};
    const Ray from_inside{.origin = {0, 0, 0}, .direction = target.v0};
    ASSERT_TRUE(bvh.occluded(from_inside));
    ASSERT_EQ(bvh.count_hits(from_inside) % 2, 1u);
    const Vec3f away = uniform_point(random, 1.0f) + Vec3f{50, 0, 0};
    const Ray from_outside{.origin = away, .direction = target.v1 - away};
    ASSERT_EQ(bvh.count_hits(from_outside) % 2, 0u);
  }
}

TEST(Refit, WorksInPlaceForTheOnlyHandleAndOnACopyOtherwise) {
  kerf_tests::Mesh mesh = kerf_tests::large_among_small(100);
  const kerf_tests::Mesh before = mesh;
  Bvh bvh = build(mesh.mesh());
  const void* const nodes = layout(bvh).nodes;
  move_vertices(mesh, [](const Vec3f& v) { return v + Vec3f{0.0f, 0.5f * v.x, 0.0f}; });
  refit(bvh, mesh.mesh());
  EXPECT_EQ(layout(bvh).nodes, nodes);

  const Bvh other = bvh;
  move_vertices(mesh, [](const Vec3f& v) { return v + Vec3f{0.0f, 0.0f, 0.5f * v.x}; });
  kerf_tests::Mesh moved_once = before;
  move_vertices(moved_once, [](const Vec3f& v) { return v + Vec3f{0.0f, 0.5f * v.x, 0.0f}; });
  refit(bvh, mesh.mesh());
  EXPECT_NE(layout(bvh).nodes, nodes);
  EXPECT_EQ(layout(other).nodes, nodes);
  expect_same_answers(other, build(moved_once.mesh()), 1);
  expect_same_answers(bvh, build(mesh.mesh()), 2);
}

TEST(Refit, TrianglesThatLoseTheirAreaAreLeftOutUntilTheyHaveOneAgain) {
  kerf_tests::Mesh mesh = kerf_tests::large_among_small(120);
  Bvh bvh = build(mesh.mesh(), spatial_splits_everywhere());
  const kerf_tests::Mesh before = mesh;
  for (const std::uint32_t flat : {0u, 7u, 119u, 7u}) {
    mesh.vertices[3 * flat + 2] = mesh.vertices[3 * flat];
    EXPECT_FALSE(refit(bvh, mesh.mesh()).rebuilt);
    expect_same_answers(bvh, build(mesh.mesh()), flat);
  }
  EXPECT_EQ(bvh.statistics().degenerate_triangles, 3u);
  EXPECT_FALSE(bvh.triangle({7, 0}));
  // All that stand in one leaf, and then all.
  for (std::uint32_t flat = 1; flat < 120; ++flat) {
    mesh.vertices[3 * flat + 2] = mesh.vertices[3 * flat];
    if (flat % 37 == 0) {
      refit(bvh, mesh.mesh());
      expect_same_answers(bvh, build(mesh.mesh()), flat);
    }
  }
  EXPECT_TRUE(refit(bvh, mesh.mesh()).rebuilt);
  EXPECT_TRUE(bvh.bounds().empty());
  EXPECT_TRUE(refit(bvh, before.mesh()).rebuilt);
  expect_same_answers(bvh, build(before.mesh()), 1);
}

TEST(Refit, BuildsAnewWhereATriangleThatItDoesNotHoldGetsAnArea) {
  kerf_tests::Mesh mesh = kerf_tests::large_among_small(50);
  const Vec3f corner = mesh.vertices[4];
  mesh.vertices[4] = mesh.vertices[3];
  Bvh bvh = build(mesh.mesh());
  EXPECT_FALSE(refit(bvh, mesh.mesh()).rebuilt);
  mesh.vertices[4] = corner;
  EXPECT_TRUE(refit(bvh, mesh.mesh()).rebuilt);
  expect_same_answers(bvh, build(mesh.mesh()), 1);
}

TEST(Refit, RefusesWhatABuildRefusesAndStaysAsItWas) {
  kerf_tests::Mesh mesh = kerf_tests::large_among_small(50);
  Bvh bvh = build(mesh.mesh());
  const auto code_of = [&](std::span<const TriangleMesh> meshes) {
    try {
      refit(bvh, meshes);
    } catch (const Error& error) {
      return error.code();
    }
    return Error::Code{};
  };
  kerf_tests::Mesh wrong = mesh;
  move_vertices(wrong, [](const Vec3f& v) { return v * 2.0f; });
  wrong.vertices[100].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code_of(std::array{wrong.mesh()}), Error::non_finite_vertex);
  wrong.vertices[100].y = 0x1p126f;
  EXPECT_EQ(code_of(std::array{wrong.mesh()}), Error::non_finite_vertex);
  wrong.vertices.resize(149);
  wrong.vertices[100].y = 0.0f;
  EXPECT_EQ(code_of(std::array{wrong.mesh()}), Error::index_out_of_range);
  wrong.triangles.resize(49);
  EXPECT_EQ(code_of(std::array{wrong.mesh()}), Error::invalid_argument);
  EXPECT_EQ(code_of({}), Error::invalid_argument);
  EXPECT_EQ(code_of(std::array{mesh.mesh(), mesh.mesh()}), Error::invalid_argument);
  expect_same_answers(bvh, build(mesh.mesh()), 1);
}

TEST(Refit, SkipsTrianglesThatAreNotFiniteOnRequest) {
  kerf_tests::Mesh mesh = kerf_tests::large_among_small(80);
  const BuildOptions skip{.alpha = 0.0f, .max_reference_ratio = 3.0f, .non_finite = NonFinite::skip};
  Bvh bvh = build(mesh.mesh(), skip);
  const Vec3f corner = mesh.vertices[30];
  mesh.vertices[30].x = std::numeric_limits<float>::infinity();
  mesh.vertices[61].z = std::numeric_limits<float>::quiet_NaN();
  mesh.vertices[91] = mesh.vertices[90];
  EXPECT_FALSE(refit(bvh, mesh.mesh(), skip).rebuilt);
  expect_same_answers(bvh, build(mesh.mesh(), skip), 1);
  mesh.vertices[30] = corner;
  EXPECT_FALSE(refit(bvh, mesh.mesh(), skip).rebuilt);
  expect_same_answers(bvh, build(mesh.mesh(), skip), 2);
}

TEST(Refit, TheReportSaysWhatItCosts) {
  workbench::Solid sphere = workbench::make_sphere(5);
  const workbench::Solid before = sphere;
  Bvh bvh = build(sphere.mesh());
  EXPECT_NEAR(refit(bvh, sphere.mesh()).cost_ratio, 1.0, 0.02);
  move_vertices(sphere, [](const Vec3f& v) { return v * 3.0f; });
  EXPECT_NEAR(refit(bvh, sphere.mesh()).cost_ratio, 1.0, 0.02);
  // Every vertex anywhere.
  std::mt19937 random(1);
  for (Vec3f& v : sphere.vertices) std::swap(v, sphere.vertices[random() % sphere.vertices.size()]);
  EXPECT_GT(refit(bvh, sphere.mesh()).cost_ratio, 3.0);
  EXPECT_NEAR(refit(bvh, before.mesh()).cost_ratio, 1.0, 0.02);
}

std::string bytes_of(const Bvh& bvh) {
  const TemporaryDirectory directory;
  bvh.save(directory / "a.kerf");
  std::ifstream file(directory / "a.kerf", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Refit, IsTheSameOnAnyNumberOfThreadsAndInstructionSet) {
  workbench::Solid torus = workbench::make_torus(48, 24);
  const workbench::Solid before = torus;
  move_vertices(torus, [](const Vec3f& v) { return bent(v, 0.3f); });
  std::map<std::uint32_t, std::string> expected_of_width;
  kerf_tests::for_each_target([&](const Target&) {
    for (const unsigned threads : {1u, 2u, 0u}) {
      Bvh bvh = build(before.mesh());
      refit(bvh, torus.mesh(), {.threads = threads});
      const std::string bytes = bytes_of(bvh);
      std::string& expected = expected_of_width[layout(bvh).width];
      if (expected.empty()) expected = bytes;
      EXPECT_TRUE(bytes == expected);
    }
  });
}

// Thirteen bytes from one to the next, so that most are at addresses of no float; nothing behind the last.
TEST(Refit, VerticesMayLieAtAnyAddress) {
  kerf_tests::Mesh mesh = kerf_tests::large_among_small(100);
  const Bvh before = build(mesh.mesh(), spatial_splits_everywhere());
  move_vertices(mesh, [](const Vec3f& v) { return bent(v, 1.0f); });
  constexpr std::size_t stride = sizeof(Vec3f) + 1;
  const std::size_t count = mesh.vertices.size();
  std::vector<std::byte> bytes(stride * count);
  std::byte* const first = bytes.data() + 1;
  for (std::size_t i = 0; i < count; ++i) std::memcpy(first + stride * i, &mesh.vertices[i], sizeof(Vec3f));
  const TriangleMesh scattered{{static_cast<const void*>(first), count, stride}, mesh.triangles};
  kerf_tests::for_each_target([&](const Target&) {
    Bvh expected = before, found = before;
    refit(expected, mesh.mesh());
    refit(found, scattered);
    EXPECT_TRUE(bytes_of(found) == bytes_of(expected));
  });
}

TEST(Refit, HierarchiesFromFilesAreRefitted) {
  kerf_tests::Mesh mesh = kerf_tests::large_among_small(100);
  const TemporaryDirectory directory;
  build(mesh.mesh(), spatial_splits_everywhere()).save(directory / "a.kerf");
  Bvh mapped = Bvh::map(directory / "a.kerf"), loaded = Bvh::load(directory / "a.kerf");
  move_vertices(mesh, [](const Vec3f& v) { return bent(v, 1.0f); });
  for (Bvh* bvh : {&mapped, &loaded}) {
    EXPECT_FALSE(refit(*bvh, mesh.mesh()).rebuilt);
    expect_same_answers(*bvh, build(mesh.mesh()), 1);
  }
  // What was refitted can be saved, also while other triangles stand in for some.
  mesh.vertices[1] = mesh.vertices[0];
  refit(mapped, mesh.mesh());
  mapped.save(directory / "b.kerf");
  Bvh again = Bvh::load(directory / "b.kerf");
  move_vertices(mesh, [](const Vec3f& v) { return bent(v, 1.0f); });
  EXPECT_FALSE(refit(again, mesh.mesh()).rebuilt);
  Bvh built = build(mesh.mesh());
  expect_same_answers(again, built, 2);
}

TEST(Refit, AHierarchyOfNothingStaysOne) {
  Bvh bvh;
  EXPECT_THROW(refit(bvh, TriangleMesh{}), Error);
  refit(bvh, std::span<const TriangleMesh>());
  EXPECT_TRUE(bvh.bounds().empty());
}

}  // namespace
}  // namespace kerf
