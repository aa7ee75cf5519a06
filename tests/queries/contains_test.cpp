#include <functional>

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

// On the same side of each face as the vertex opposite to it, or on a face.
Side side_of_tetrahedron(const Vec3f (&v)[4], const Vec3f& point) {
  const auto volume = [](const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
    using exact::vector;
    return exact::dot(vector(b) - vector(a), exact::cross(vector(c) - vector(a), vector(d) - vector(a)));
  };
  Side side = Side::inside;
  for (int i = 0; i < 4; ++i) {
    const Vec3f &a = v[(i + 1) % 4], &b = v[(i + 2) % 4], &c = v[(i + 3) % 4];
    const exact::Number same = volume(a, b, c, v[i]) * volume(a, b, c, point);
    if (same < 0) return Side::outside;
    if (same == 0) side = Side::on;
  }
  return side;
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
      const Side side = side_of_tetrahedron(v, p);
      ASSERT_EQ(bvh.side(p), side);
      ASSERT_EQ(bvh.contains(p), side != Side::outside);
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
      const auto in = [&p](const Vec3f& a, const Vec3f& b, auto less) {
        return less(a.x, p.x) && less(a.y, p.y) && less(a.z, p.z) && less(p.x, b.x) && less(p.y, b.y) &&
               less(p.z, b.z);
      };
      const Side side = in(lower, upper, std::less<>())         ? Side::inside
                        : in(lower, upper, std::less_equal<>()) ? Side::on
                                                                : Side::outside;
      RC_ASSERT(bvh.side(p) == side);
      RC_ASSERT(bvh.contains(p) == (side != Side::outside));
    }
  }));
}

TEST(Contains, AnEmptyHierarchyContainsNothing) {
  EXPECT_FALSE(Bvh().contains({0, 0, 0}));
  EXPECT_EQ(Bvh().side({0, 0, 0}), Side::outside);
  EXPECT_EQ(Bvh().signed_distance({0, 0, 0}), infinity);
}

// Points on the surface, where the ray that is counted begins at a corner, at an edge or inside a triangle.
TEST(Contains, EveryVertexOfASurfaceLiesOnIt) {
  for (const workbench::Solid& solid : {workbench::make_sphere(3), workbench::make_torus(24, 12)}) {
    const Bvh bvh = build(solid.mesh(), spatial_splits_everywhere());
    for (const Vec3f& vertex : solid.vertices) ASSERT_EQ(bvh.side(vertex), Side::on);
  }
}

TEST(Contains, APointThatIsNotANumberIsNowhere) {
  const Bvh bvh = build(workbench::make_box({-1, -1, -1}, {1, 1, 1}).mesh());
  EXPECT_FALSE(bvh.contains({std::numeric_limits<float>::quiet_NaN(), 0, 0}));
  EXPECT_FALSE(bvh.contains({infinity, 0, 0}));
  EXPECT_EQ(bvh.signed_distance({infinity, 0, 0}), infinity);
}

}  // namespace
}  // namespace kerf
