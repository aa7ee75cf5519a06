#include "construction/presplit/presplit.hpp"

#include <algorithm>
#include <array>
#include <queue>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "construction/construct.hpp"
#include "construction/input.hpp"
#include "math/clip.hpp"
#include "tree/validate.hpp"

namespace kerf {
namespace {

// Long thin triangles at all angles: what both ways of splitting were made for.
class Presplit : public testing::Test {
 protected:
  Presplit() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-1.0f, 1.0f);
    for (std::uint32_t i = 0; i < 500; ++i) {
      const std::array<float, 3> a{place(random), place(random), place(random)};
      vertices.push_back(a);
      vertices.push_back({a[0] + 0.01f, a[1], a[2] + 0.01f * place(random)});
      vertices.push_back({place(random), place(random), place(random)});
      triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
  }

  TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }

  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

using Split = std::vector<Reference> (*)(const Geometry&, std::vector<Reference>, std::size_t);

TEST_F(Presplit, ComesNearTheLimitAndNeverAboveIt) {
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  for (const Split split : {split_by_area, split_by_edge_volume}) {
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
  for (const Split split : {split_by_area, split_by_edge_volume}) {
    const auto parts = split(geometry, make_references(geometry).references, 100);
    ASSERT_EQ(parts.size(), triangles.size());
    for (std::uint32_t i = 0; i < parts.size(); ++i)
      EXPECT_EQ(parts[i].bounds(), bounds_of(geometry.triangle(i)));
  }
}

TEST_F(Presplit, ByAreaCutsTheLargestBoxesFirst) {
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  const auto parts = split_by_area(geometry, make_references(geometry).references, 2000);

  // The oracle cuts the largest box there is until there are as many.
  struct Piece {
    Box3f box;
    std::uint32_t id;
    bool operator<(const Piece& other) const { return half_area(box) < half_area(other.box); }
  };
  std::priority_queue<Piece> queue;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) queue.push({bounds_of(geometry.triangle(i)), i});
  while (queue.size() < parts.size()) {
    const Piece piece = queue.top();
    queue.pop();
    const Vec3f e = extent(piece.box);
    const std::array<float, 3> size{e.x, e.y, e.z};
    const int axis = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
    const float middle = 0.5f * (piece.box.lower[axis] + piece.box.upper[axis]);
    const ChoppedBoxes halves = chop(geometry.triangle(piece.id), piece.box, axis, middle);
    queue.push({halves.left, piece.id});
    queue.push({halves.right, piece.id});
  }
  std::multiset<std::pair<std::uint32_t, float>> expected, actual;
  for (; !queue.empty(); queue.pop()) expected.insert({queue.top().id, half_area(queue.top().box)});
  for (const Reference& part : parts) actual.insert({part.primitive, half_area(part.bounds())});
  EXPECT_EQ(actual, expected);
}

TEST_F(Presplit, ByEdgeVolumeNeverCutsATriangleWhoseEdgesAreFlat) {
  vertices.insert(vertices.end(), {{-9, -9, 0}, {9, -9, 0}, {-9, 9, 0}});
  triangles.push_back({1500, 1501, 1502});
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  const auto parts = split_by_edge_volume(geometry, make_references(geometry).references, 3000);
  EXPECT_EQ(std::count_if(parts.begin(), parts.end(), [](const Reference& r) { return r.primitive == 500; }),
            1);
}

TEST_F(Presplit, PartsCoverTheirTriangles) {
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  for (const Builder builder : {Builder::esc, Builder::evh}) {
    BuildOptions options;
    options.builder = builder;
    options.presplit_references = 4000;
    for (const std::uint32_t leaf_size : {1u, 8u}) {  // with one reference a leaf, each part stands alone
      options.max_leaf_size = leaf_size;
      EXPECT_EQ(validate(build_tree(geometry, options), geometry), std::vector<std::string>{});
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
    for (const Split split : {split_by_area, split_by_edge_volume}) {
      const std::size_t count = split(geometry, make_references(geometry).references, 1000).size();
      EXPECT_LE(count, 1000u);
      EXPECT_GE(count, 998u);
    }
  }
}

// Parts as small as rounding, whose edges do not get shorter by halving others.
TEST_F(Presplit, AnyLimitIsReached) {
  for (const float scale : {1.0f, 1e-6f}) {
    std::vector<std::array<float, 3>> corners;
    std::mt19937 random(9);
    std::uniform_real_distribution<float> place(-scale, scale);
    for (int i = 0; i < 60; ++i)
      corners.push_back({place(random), 1.0f + place(random), place(random) * 1e-3f});
    const TriangleMesh m{.vertices = corners, .triangles = std::span(triangles).first(20)};
    const Geometry geometry({&m, 1});
    for (const Split split : {split_by_area, split_by_edge_volume}) {
      EXPECT_LE(split(geometry, make_references(geometry).references, 100'000).size(), 100'000u);
    }
  }
}

TEST(MergeParts, KeepsEachTriangleOnceALeaf) {
  BinaryTree tree{.nodes = {{{{0, 0, 0}, {1, 1, 1}}, 1, 0},
                            {{{0, 0, 0}, {1, 1, 1}}, 0, 4},
                            {{{0, 0, 0}, {1, 1, 1}}, 4, 2}},
                  .references = {3, 1, 3, 3, 1, 3}};
  merge_parts_in_leaves(tree);
  EXPECT_EQ(tree.references, (UninitializedVector<std::uint32_t>{3, 1, 1, 3}));
  EXPECT_EQ(tree.nodes[1].count, 2u);
  EXPECT_EQ(tree.nodes[2].first, 2u);
  EXPECT_EQ(tree.nodes[2].count, 2u);
}

}  // namespace
}  // namespace kerf
