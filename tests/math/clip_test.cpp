#include "math/clip.hpp"

#include <random>

#include <gtest/gtest.h>

#include "construction/sbvh/subtree.hpp"
#include "support/random_triangles.hpp"

namespace {

using kerf::Box3f;
using kerf::Triangle;
using kerf::Vec3f;

// Whether the box holds the point up to the rounding of double precision with which the point was computed.
bool holds(const Box3f& box, const double (&p)[3], double scale) {
  for (int k = 0; k < 3; ++k) {
    if (!(box.lower[k] - 1e-13 * scale <= p[k] && p[k] <= box.upper[k] + 1e-13 * scale)) return false;
  }
  return true;
}

class Clip : public testing::Test {
 protected:
  // Chops random triangles, stretched by `stretch`, again and again. Every point must lie in one of the
  // boxes.
  void expect_no_point_lost(float size, Vec3f stretch, Vec3f offset) {
    std::mt19937 random(7);
    const auto uniform = [&random] { return static_cast<float>(random() >> 8) / 16777216.0f; };
    const auto point = [&] {
      return Vec3f{offset.x + size * stretch.x * uniform(), offset.y + size * stretch.y * uniform(),
                   offset.z + size * stretch.z * uniform()};
    };
    const double scale = double{size} + std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z);
    for (int round = 0; round < 2000; ++round) {
      const Triangle triangle{point(), point(), point()};
      Box3f box = kerf::bounds_of(triangle);
      for (int cut = 0; cut < 4 && !box.empty(); ++cut) {
        const int axis = static_cast<int>(random() % 3);
        const float plane = box.lower[axis] + (box.upper[axis] - box.lower[axis]) * uniform();
        const auto [left, right] = kerf::chop(triangle, box, axis, plane);
        for (int sample = 0; sample < 20; ++sample) {
          double u = uniform(), v = uniform();
          if (u + v > 1) u = 1 - u, v = 1 - v;
          double p[3];
          for (int k = 0; k < 3; ++k) {
            p[k] = double{triangle.v0[k]} + u * (double{triangle.v1[k]} - triangle.v0[k]) +
                   v * (double{triangle.v2[k]} - triangle.v0[k]);
          }
          if (!holds(box, p, 0.0)) continue;
          if (p[axis] <= plane) {
            EXPECT_TRUE(holds(left, p, scale));
          }
          if (p[axis] >= plane) {
            EXPECT_TRUE(holds(right, p, scale));
          }
        }
        box = random() % 2 ? left : right;
      }
    }
  }
};

TEST_F(Clip, LosesNoPointOfATriangle) {
  expect_no_point_lost(1.0f, {1, 1, 1}, {0, 0, 0});
}
TEST_F(Clip, LosesNoPointOfASliver) {
  expect_no_point_lost(1.0f, {1, 1e-6f, 1e-3f}, {0, 0, 0});
}
TEST_F(Clip, LosesNoPointFarFromTheOrigin) {
  expect_no_point_lost(1.0f, {1, 1, 1}, {1000, -3000, 7});
}
TEST_F(Clip, LosesNoPointOfATinyTriangle) {
  expect_no_point_lost(1e-9f, {1, 1, 1}, {0, 0, 0});
}
TEST_F(Clip, LosesNoPointOfAHugeTriangle) {
  expect_no_point_lost(1e9f, {1, 1, 1}, {0, 0, 0});
}

TEST_F(Clip, PartsMeetAtThePlaneAndNoneLeavesTheBox) {
  const Triangle triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto [left, right] = kerf::chop(triangle, kerf::bounds_of(triangle), 0, 1.0f);
  EXPECT_EQ(left, (Box3f{{0, 0, 0}, {1, 4, 0}}));
  EXPECT_EQ(right.lower, (Vec3f{1, 0, 0}));
  EXPECT_EQ(right.upper.x, 4.0f);
  EXPECT_NEAR(right.upper.y, 3.0f, 1e-5f);
  EXPECT_GE(right.upper.y, 3.0f);
}

TEST_F(Clip, SideThatTheTriangleDoesNotReachIsEmpty) {
  const Triangle triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto [left, right] = kerf::chop(triangle, kerf::bounds_of(triangle), 2, -1.0f);
  EXPECT_TRUE(left.empty());
  EXPECT_EQ(right, kerf::bounds_of(triangle));
}

TEST_F(Clip, VectorsGiveTheSamePartsAsScalars) {
  const kerf_tests::Mesh mesh = kerf_tests::random_triangles(500, 0.5f, 0.1f);
  const kerf::TriangleMesh view = mesh.mesh();
  const kerf::Geometry geometry(std::span(&view, 1));
  const kerf::BuildContext context{.geometry = &geometry};
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = geometry.triangle(i);
    const Box3f box = kerf::bounds_of(triangle);
    for (int axis = 0; axis < 3; ++axis) {
      const float plane = box.lower[axis] + 0.3f * (box.upper[axis] - box.lower[axis]);
      const auto [left, right] = kerf::chop(triangle, box, axis, plane);
      Box3f vector_left, vector_right;
      kerf::chop_reference(context, kerf::Reference(box, i), axis, plane, vector_left, vector_right);
      EXPECT_EQ(left, vector_left);
      EXPECT_EQ(right, vector_right);
    }
  }
}

}  // namespace
