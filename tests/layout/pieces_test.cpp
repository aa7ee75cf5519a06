#include "layout/pieces.hpp"

#include <algorithm>
#include <bit>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/build.hpp>

#include "layout/move_leaves.hpp"
#include "math/triangle.hpp"
#include "structure.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"

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
TEST(Pieces, EveryPointOfAMovedTriangleLiesInTheBoxOfALeafThatHoldsOne) {
  const kerf_tests::Mesh mesh = kerf_tests::large_among_small(600);
  kerf_tests::for_each_target([&](Target target) {
    const Bvh bvh = build(mesh.mesh(), spatial_splits_everywhere());
    const WideBvh& wide = Structure::of(bvh).wide;
    const Pieces pieces(wide, mesh.triangles.size());
    std::mt19937 random(3);
    kerf_tests::Mesh moved = mesh;
    const TriangleMesh view = moved.mesh();
    const Geometry geometry({&view, 1});
    for (const float size : {0.0f, 0.01f, 1.0f, 1e6f}) {
      for (Vec3f& v : moved.vertices) v = v + uniform_point(random, size);
      std::vector<std::vector<Box3f>> boxes(mesh.triangles.size());
      std::size_t smaller = 0;
      for_each_leaf(wide, [&](ChildLink leaf) {
        MovedLeaf leaf_moved;
        move_leaves(target, pieces, geometry, wide, {&leaf, 1}, &leaf_moved);
        EXPECT_EQ(leaf_moved.flat, 0u);
        Box3f whole;
        for (std::uint32_t i = 0; i < leaf.count(); ++i) {
          const std::uint32_t id = triangle_id(wide, leaf, i);
          EXPECT_EQ(triangle_in(wide, leaf, i), geometry.triangle(id));
          whole = merge(whole, bounds_of(geometry.triangle(id)));
          boxes[id].push_back(leaf_moved.box);
        }
        EXPECT_TRUE(contains(whole, leaf_moved.box));
        smaller += half_area(leaf_moved.box) < 0.9f * half_area(whole);
      });
      EXPECT_GT(smaller, 10u);
      // Anywhere, and where pieces end.
      const auto expect_found = [&](std::uint32_t id, std::uint32_t u, std::uint32_t v, std::uint32_t steps) {
        if (u + v > steps) u = std::min(u, steps), v = steps - u;
        const Triangle t = geometry.triangle(id);
        const exact::Vector a = exact::vector(t.v0);
        const exact::Vector p = a + exact::Number(u, steps) * (exact::vector(t.v1) - a) +
                                exact::Number(v, steps) * (exact::vector(t.v2) - a);
        EXPECT_TRUE(std::any_of(boxes[id].begin(), boxes[id].end(),
                                [&](const Box3f& box) { return lies_in(p, box); }));
      };
      for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
        for (int k = 0; k < 4; ++k) {
          const auto u = static_cast<std::uint32_t>(random() % 4097),
                     v = static_cast<std::uint32_t>(random() % 4097);
          expect_found(id, u, k == 0 ? 0 : v, 4096);  // on an edge, too
        }
      }
      for_each_leaf(wide, [&](ChildLink leaf) {
        for (std::uint32_t rest = pieces.in_leaf(leaf); rest != 0; rest &= rest - 1) {
          const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
          for (const PieceCorner& corner : pieces.corners(leaf, i)) {
            const auto near = [&](std::uint32_t step) {
              return static_cast<std::uint32_t>(std::max<std::int64_t>(
                  0, 16 * std::int64_t{step} - 8 + static_cast<std::int64_t>(random() % 17)));
            };
            expect_found(triangle_id(wide, leaf, i), near(corner.u), near(corner.v), 16 * 65535);
          }
        }
      });
    }
  });
}

}  // namespace
}  // namespace kerf
