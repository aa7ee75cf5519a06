#include "construction/presplit/presplit.hpp"

#include <kerf/kerf.hpp>

#include "construction/construct.hpp"
#include "construction/input.hpp"
#include "construction/presplit/esc.hpp"
#include "construction/presplit/evh.hpp"
#include "construction/presplit/long_triangles.hpp"
#include "math/triangle.hpp"
#include "tree/validate.hpp"

namespace kerf {
namespace {

class Presplit : public LongTriangles {};

TEST_F(Presplit, ComesNearTheLimitAndNeverAboveIt) {
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  for (SplitReferences* const split : {split_by_area, split_by_edge_volume}) {
    for (const std::size_t limit : {500u, 501u, 700u, 1500u, 4000u}) {
      const std::size_t count = split(geometry, make_references(geometry).references, limit).size();
      EXPECT_LE(count, limit);
      EXPECT_GE(count, limit - 2);
    }
  }
}

TEST_F(Presplit, LeavesAllWholeWhereTheLimitHasNoRoom) {
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  for (SplitReferences* const split : {split_by_area, split_by_edge_volume}) {
    const auto parts = split(geometry, make_references(geometry).references, 100);
    ASSERT_EQ(parts.size(), triangles.size());
    for (std::uint32_t i = 0; i < parts.size(); ++i)
      EXPECT_EQ(parts[i].bounds(), bounds_of(geometry.triangle(i)));
  }
}

TEST_F(Presplit, PartsCoverTheirTriangles) {
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  for (const Builder builder : {Builder::esc, Builder::evh}) {
    BuildOptions options;
    options.builder = builder;
    options.presplit_references = 4000;
    for (const std::uint32_t leaf_size : {1u, 8u}) {  // with one reference per leaf, each part stands alone
      options.max_leaf_size = leaf_size;
      EXPECT_EQ(validate(construct(geometry, options), geometry), std::vector<std::string>{});
    }
  }
}

TEST_F(Presplit, ChangesNoHit) {
  BuildOptions options;
  options.builder = Builder::bvh;
  const Bvh whole = build(mesh(), options);
  options.builder = Builder::esc;
  const Bvh by_area = build(mesh(), options);
  options.builder = Builder::evh;
  const Bvh by_edge_volume = build(mesh(), options);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Ray ray{.origin = {place(random), place(random), place(random)},
                  .direction = {place(random), place(random), place(random)}};
    const auto expected = whole.intersect(ray);
    hits += expected.has_value();
    EXPECT_EQ(by_area.intersect(ray), expected);
    EXPECT_EQ(by_edge_volume.intersect(ray), expected);
  }
  EXPECT_GT(hits, 200);
}

TEST_F(Presplit, OnExtremeCoordinatesEnds) {
  for (const float scale : {1e-30f, 1e9f, 3e37f}) {
    auto scaled = vertices;
    for (auto& v : scaled) {
      for (float& x : v) x *= scale;
    }
    const TriangleMesh m{.vertices = scaled, .triangles = triangles};
    const Geometry geometry({&m, 1});
    for (SplitReferences* const split : {split_by_area, split_by_edge_volume}) {
      const std::size_t count = split(geometry, make_references(geometry).references, 1000).size();
      EXPECT_LE(count, 1000u);
      EXPECT_GE(count, 998u);
    }
  }
}

// Parts as small as rounding: halving one edge does not shorten the others.
TEST_F(Presplit, AnyLimitIsReached) {
  for (const float scale : {1.0f, 1e-6f}) {
    std::vector<std::array<float, 3>> corners;
    std::mt19937 random(9);
    std::uniform_real_distribution<float> place(-scale, scale);
    for (int i = 0; i < 60; ++i)
      corners.push_back({place(random), 1.0f + place(random), place(random) * 1e-3f});
    const TriangleMesh m{.vertices = corners, .triangles = std::span(triangles).first(20)};
    const Geometry geometry({&m, 1});
    for (SplitReferences* const split : {split_by_area, split_by_edge_volume}) {
      EXPECT_LE(split(geometry, make_references(geometry).references, 100'000).size(), 100'000u);
    }
  }
}

}  // namespace
}  // namespace kerf
