#include "construction/input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "math/triangle.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"

namespace {

using kerf::Error;
using kerf_tests::Mesh;

struct Failure {
  int code;
  std::string sentence;
};

Failure failure_of(const Mesh& mesh) {
  try {
    kerf::build(mesh.mesh());
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {-1, "no error"};
}

Mesh one_triangle(float size) {
  return {.vertices = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, .triangles = {{0, 1, 2}}};
}

TEST(Input, NamesTheVertexThatIsNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Mesh mesh = kerf_tests::random_triangles(10, 0.1f, 0.1f);
    mesh.vertices[17].y = bad;
    const Failure failure = failure_of(mesh);
    EXPECT_EQ(failure.code, Error::non_finite_vertex);
    EXPECT_NE(failure.sentence.find("vertex 17"), std::string::npos) << failure.sentence;
  }
}

// Every tenth triangle has a vertex that is not finite, or so large that it is refused by default.
Mesh with_bad_vertices(std::uint32_t triangles) {
  Mesh mesh = kerf_tests::random_triangles(triangles, 0.2f, 0.2f);
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity(),
                       0x1p126f};
  for (std::size_t i = 0; i < triangles; i += 10) mesh.vertices[3 * i + i % 3].y = bad[i / 10 % 3];
  return mesh;
}

TEST(Input, SkippedTrianglesAreCountedAndTheOthersKeepTheirNumbers) {
  constexpr std::uint32_t triangles = 20'000;  // several blocks
  const Mesh mesh = with_bad_vertices(triangles);
  Mesh good = mesh;  // a degenerate triangle in the place of each bad one
  for (std::size_t i = 0; i < triangles; i += 10) good.triangles[i] = {1, 1, 1};
  kerf_tests::for_each_target([&](const kerf::Target&) {
    const kerf::Bvh bvh = kerf::build(mesh.mesh(), {.non_finite = kerf::NonFinite::skip});
    EXPECT_EQ(bvh.statistics().triangles, triangles);
    EXPECT_EQ(bvh.statistics().non_finite_triangles, triangles / 10);
    EXPECT_EQ(bvh.statistics().degenerate_triangles, 0u);
    const kerf::Bvh other = kerf::build(good.mesh());
    EXPECT_EQ(other.statistics().non_finite_triangles, 0u);
    EXPECT_EQ(bvh.bounds(), other.bounds());
    EXPECT_EQ(bvh.triangles_in(bvh.bounds()), other.triangles_in(bvh.bounds()));
    EXPECT_EQ(bvh.statistics().references, other.statistics().references);
  });
}

TEST(Input, EveryBuilderSkipsTriangles) {
  const Mesh mesh = with_bad_vertices(200);
  for (const kerf::BuilderInfo& builder : kerf::builders()) {
    const kerf::BuildOptions options{.builder = builder.builder, .non_finite = kerf::NonFinite::skip};
    const kerf::Bvh bvh = kerf::build(mesh.mesh(), options);
    EXPECT_EQ(bvh.statistics().non_finite_triangles, 20u) << builder.name;
    EXPECT_EQ(bvh.triangles_in(bvh.bounds()).size(), 180u) << builder.name;
    EXPECT_EQ(kerf::build_tree(mesh.mesh(), options).non_finite_triangles(), 20u) << builder.name;
  }
}

TEST(Input, SkippingLeavesNothingOfAMeshWithoutAFiniteTriangle) {
  Mesh mesh = one_triangle(1.0f);
  mesh.vertices[1].z = std::numeric_limits<float>::infinity();
  const kerf::Bvh bvh = kerf::build(mesh.mesh(), {.non_finite = kerf::NonFinite::skip});
  EXPECT_EQ(bvh.statistics().nodes, 0u);
  EXPECT_EQ(bvh.statistics().non_finite_triangles, 1u);
}

TEST(Input, AnIndexThatIsOutOfRangeIsNotSkipped) {
  Mesh mesh = one_triangle(1.0f);
  mesh.triangles[0][2] = 3;
  EXPECT_THROW(kerf::build(mesh.mesh(), {.non_finite = kerf::NonFinite::skip}), Error);
}

TEST(Input, IgnoresAVertexThatNoTriangleUses) {
  Mesh mesh = one_triangle(1.0f);
  mesh.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  EXPECT_EQ(kerf::build(mesh.mesh()).statistics().references, 1u);
}

TEST(Input, NamesTheTriangleAndTheIndexThatIsOutOfRange) {
  Mesh mesh = kerf_tests::random_triangles(10, 0.1f, 0.1f);
  mesh.triangles[6][1] = 30;
  const Failure failure = failure_of(mesh);
  EXPECT_EQ(failure.code, Error::index_out_of_range);
  EXPECT_NE(failure.sentence.find("triangle 6"), std::string::npos) << failure.sentence;
  EXPECT_NE(failure.sentence.find("30"), std::string::npos) << failure.sentence;
}

TEST(Input, CountsDegenerateTrianglesAndLeavesThemOut) {
  Mesh mesh = one_triangle(1.0f);
  mesh.vertices.push_back({2, 0, 0});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 0, 0}, {0, 1, 1}, {0, 1, 3}});
  const kerf::Bvh bvh = kerf::build(mesh.mesh());
  EXPECT_EQ(bvh.statistics().degenerate_triangles, 3u);
  EXPECT_EQ(bvh.statistics().references, 1u);
  EXPECT_EQ(bvh.statistics().triangles, 4u);
}

TEST(Input, KeepsTrianglesOfAnySizeThatHaveAnArea) {
  for (const float size : {1e-30f, 1e-20f, 1e-9f, 1.0f, 1e9f, 1e18f, 1e25f}) {
    EXPECT_EQ(kerf::build(one_triangle(size).mesh()).statistics().degenerate_triangles, 0u) << size;
  }
}

TEST(Input, MeshOfNothingGivesATreeOfNothing) {
  EXPECT_EQ(kerf::build(Mesh{}.mesh()).statistics().nodes, 0u);
  Mesh degenerate = one_triangle(0.0f);
  EXPECT_EQ(kerf::build(degenerate.mesh()).statistics().nodes, 0u);
}

TEST(Input, StridedVerticesAndSeveralMeshesGiveTheSameBoxes) {
  struct Vertex {
    float position[3];
    float normal[3];
  };
  const Mesh mesh = kerf_tests::random_triangles(100, 0.2f, 0.2f);
  std::vector<Vertex> strided;
  for (const kerf::Vec3f& v : mesh.vertices) strided.push_back({{v.x, v.y, v.z}, {9, 9, 9}});
  const kerf::Bvh one = kerf::build(mesh.mesh());
  const kerf::Bvh other = kerf::build({.vertices = strided, .triangles = mesh.triangles});
  EXPECT_EQ(one.bounds(), other.bounds());
  EXPECT_EQ(one.statistics().references, other.statistics().references);

  const std::array<kerf::TriangleMesh, 2> halves{
      kerf::TriangleMesh{.vertices = mesh.vertices, .triangles = std::span(mesh.triangles).first(50)},
      kerf::TriangleMesh{.vertices = strided, .triangles = std::span(mesh.triangles).last(50)}};
  const kerf::Bvh both = kerf::build(halves);
  EXPECT_EQ(one.bounds(), both.bounds());
  EXPECT_EQ(one.statistics().references, both.statistics().references);
}

// Thin and thick triangles, some of them in an axis-aligned plane, some without an area. Each vertex is
// followed by a value that is not a number.
TEST(Input, OnEveryInstructionSetTrianglesWithAnAreaBecomeTheirBoxes) {
  Mesh mesh = kerf_tests::random_triangles(9000, 0.2f, 1e-3f);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    kerf::Vec3f* const corners = &mesh.vertices[3 * i];
    if (i % 3 == 1) corners[0].y = corners[1].y = corners[2].y = -0.0f;
    if (i % 5 == 1) corners[2] = corners[0] + (corners[1] - corners[0]) * 0.5f;
    if (i % 7 == 1) corners[2] = corners[1];
    if (i % 11 == 1) std::for_each(corners, corners + 3, [](kerf::Vec3f& v) { v = v * 1e-30f; });
  }
  std::vector<std::array<float, 4>> vertices;
  for (const kerf::Vec3f& v : mesh.vertices)
    vertices.push_back({v.x, v.y, v.z, std::numeric_limits<float>::quiet_NaN()});
  const kerf::TriangleMesh view{.vertices = vertices, .triangles = mesh.triangles};
  const kerf::Geometry geometry(std::span(&view, 1));
  kerf_tests::for_each_target([&](const kerf::Target&) {
    const std::vector<kerf::Reference> references = kerf::make_references(geometry).references;
    std::size_t count = 0;
    for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
      const kerf::Triangle triangle = geometry.triangle(id);
      if (kerf::is_degenerate(triangle)) continue;
      ASSERT_LT(count, references.size());
      EXPECT_EQ(references[count].primitive, id);
      EXPECT_EQ(references[count++].bounds(), kerf::bounds_of(triangle));
    }
    EXPECT_EQ(count, references.size());
    EXPECT_LT(count, 8000u);
  });
}

}  // namespace
