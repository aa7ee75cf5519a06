#include "workbench/generate/solids.hpp"

#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "workbench/base/vectors.hpp"

namespace workbench {
namespace {

using namespace kerf;

// Every directed edge once, and its opposite once: closed, and turned one way all over.
void expect_closed(const Solid& solid) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& triangle : solid.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{triangle[i], triangle[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first}));
  }
}

// Sum of signed tetrahedra: positive if the triangles face outward.
double volume(const Solid& solid) {
  double sum = 0.0;
  for (const auto& [a, b, c] : solid.triangles) {
    sum += dot(solid.vertices[a], cross(solid.vertices[b], solid.vertices[c]));
  }
  return sum / 6.0;
}

TEST(Solids, SphereIsClosedAndHasItsCounts) {
  const Solid sphere = make_sphere(6, 2.0f);
  EXPECT_EQ(sphere.triangles.size(), 81920u);
  EXPECT_EQ(sphere.vertices.size(), 40962u);
  expect_closed(sphere);
  EXPECT_NEAR(volume(sphere), 4.0 / 3.0 * 3.14159265 * 8.0, 0.03);
}

TEST(Solids, TorusIsClosed) {
  const Solid torus = make_torus(64, 32, 2.0f, 0.5f);
  EXPECT_EQ(torus.triangles.size(), 4096u);
  expect_closed(torus);
  EXPECT_NEAR(volume(torus), 2.0 * 3.14159265 * 3.14159265 * 2.0 * 0.25, 0.1);
}

TEST(Solids, BoxIsClosed) {
  const Solid box = make_box({-1, -2, -3}, {1, 2, 3}, 4);
  EXPECT_EQ(box.triangles.size(), 192u);
  EXPECT_EQ(box.vertices.size(), 98u);
  expect_closed(box);
  EXPECT_NEAR(volume(box), 48.0, 1e-4);
}

}  // namespace
}  // namespace workbench
