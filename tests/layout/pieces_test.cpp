#include "layout/pieces.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/build.hpp>

#include "structure.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"
#include "support/random_triangles.hpp"

namespace kerf {
namespace {

using adversarial::uniform_point;

bool lies_in(const exact::Vector& p, const Box3f& box) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (p[i] < exact::number(box.lower[axis]) || p[i] > exact::number(box.upper[axis])) return false;
  }
  return true;
}

// In rational numbers: no point of a triangle is lost between its pieces, however far corners move.
TEST(Pieces, EveryPointOfAMovedTriangleLiesInOneOfThem) {
  const kerf_tests::Mesh mesh = kerf_tests::large_among_small(600);
  const Bvh bvh = build(mesh.mesh(), spatial_splits_everywhere());
  const WideBvh& wide = Structure::of(bvh).wide;
  const Pieces pieces(wide, mesh.triangles.size());
  std::mt19937 random(3);
  std::vector<Vec3f> vertices = mesh.vertices;
  for (const float size : {0.0f, 0.01f, 1.0f, 1e6f}) {
    for (Vec3f& v : vertices) v = v + uniform_point(random, size);
    std::vector<std::vector<Box3f>> boxes(mesh.triangles.size());
    const auto moved = [&](std::uint32_t id) {
      return Triangle{vertices[3 * id], vertices[3 * id + 1], vertices[3 * id + 2]};
    };
    std::size_t smaller = 0;
    for_each_leaf(wide, [&](ChildLink leaf) {
      const std::uint32_t divided = pieces.in_leaf(leaf);
      for (std::uint32_t i = 0; i < leaf.count(); ++i) {
        const std::uint32_t id = triangle_id(wide, leaf, i);
        const bool has_piece = (divided >> i & 1) != 0 && !pieces.corners(leaf, i).empty();
        boxes[id].push_back(has_piece ? box_of_piece(moved(id), pieces.corners(leaf, i))
                                      : bounds_of(moved(id)));
        smaller += half_area(boxes[id].back()) < 0.9f * half_area(bounds_of(moved(id)));
      }
    });
    EXPECT_GT(smaller, 10u);
    for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
      const Triangle t = moved(id);
      for (int k = 0; k < 4; ++k) {
        auto u = static_cast<std::uint32_t>(random() % 4097), v = static_cast<std::uint32_t>(random() % 4097);
        if (u + v > 4096) u = 4096 - u, v = 4096 - v;
        if (k % 4 == 0) v = 0;  // on an edge
        const exact::Vector a = exact::vector(t.v0);
        const exact::Vector p = a + exact::Number(u, 4096) * (exact::vector(t.v1) - a) +
                                exact::Number(v, 4096) * (exact::vector(t.v2) - a);
        ASSERT_TRUE(std::any_of(boxes[id].begin(), boxes[id].end(),
                                [&](const Box3f& box) { return lies_in(p, box); }));
      }
    }
  }
}

}  // namespace
}  // namespace kerf
