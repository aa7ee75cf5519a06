#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;

const float infinity = std::numeric_limits<float>::infinity();

Soup tetrahedron(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  return Soup({{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}});
}

// On the same side of each face as the vertex opposite to it; points on a face count as inside.
bool lies_in_tetrahedron(const Vec3f (&v)[4], const Vec3f& point) {
  const auto volume = [](const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
    using exact::vector;
    return exact::dot(vector(b) - vector(a), exact::cross(vector(c) - vector(a), vector(d) - vector(a)));
  };
  for (int i = 0; i < 4; ++i) {
    const Vec3f &a = v[(i + 1) % 4], &b = v[(i + 2) % 4], &c = v[(i + 3) % 4];
    if (volume(a, b, c, v[i]) * volume(a, b, c, point) < 0) return false;
  }
  return true;
}

TEST(Contains, AgreesWithExactArithmeticOnATetrahedron) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    const bool grid = round % 2 == 0;
    const auto point = [&] { return grid ? grid_point(random, 3) : uniform_point(random, 3.0f); };
    const Vec3f v[4] = {point(), point(), point(), point()};
    if (orientation(v[0], v[1], v[2], v[3]) == 0) continue;
    const Bvh bvh = build(tetrahedron(v[0], v[1], v[2], v[3]).mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 30; ++i) {
      // Any point, one on (or rounded to beside) an edge or a face, or a vertex.
      const float s = uniform(random, 0, 1), r = uniform(random, 0, 1 - s);
      const Vec3f near = v[0] + s * (v[1] - v[0]) + r * (v[2] - v[0]);
      const Vec3f p = i % 3 == 0 ? point() : i % 3 == 1 ? near : v[i % 4];
      ASSERT_EQ(bvh.contains(p), lies_in_tetrahedron(v, p));
      const float distance = bvh.signed_distance(p);
      ASSERT_TRUE(distance == 0.0f || (distance < 0.0f) == bvh.contains(p));
    }
  }
}

// Boxes with corners on a grid, asked about points of the grid, many of which lie on planes, edges and
// vertices.
TEST(Contains, IsExactOnDividedBoxes) {
  EXPECT_TRUE(rc::check("a divided box contains just the points between its corners", [] {
    const auto coordinate = [](int from, int to) { return static_cast<float>(*rc::gen::inRange(from, to)); };
    const Vec3f lower{coordinate(-4, 5), coordinate(-4, 5), coordinate(-4, 5)};
    const Vec3f upper = lower + Vec3f{coordinate(1, 5), coordinate(1, 5), coordinate(1, 5)};
    const auto divisions = *rc::gen::inRange<std::uint32_t>(1, 5);
    const Bvh bvh = build(workbench::make_box(lower, upper, divisions).mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 20; ++i) {
      const Vec3f p{coordinate(-5, 10), coordinate(-5, 10), coordinate(-5, 10)};
      RC_ASSERT(bvh.contains(p) == kerf::contains(Box3f{lower, upper}, Box3f{p, p}));
    }
  }));
}

TEST(Contains, AnEmptyHierarchyContainsNothing) {
  EXPECT_FALSE(Bvh().contains({0, 0, 0}));
  EXPECT_EQ(Bvh().signed_distance({0, 0, 0}), infinity);
}

TEST(Contains, APointThatIsNotANumberIsNowhere) {
  const Bvh bvh = build(workbench::make_box({-1, -1, -1}, {1, 1, 1}).mesh());
  EXPECT_FALSE(bvh.contains({std::numeric_limits<float>::quiet_NaN(), 0, 0}));
  EXPECT_FALSE(bvh.contains({infinity, 0, 0}));
  EXPECT_EQ(bvh.signed_distance({infinity, 0, 0}), infinity);
}

}  // namespace
}  // namespace kerf
