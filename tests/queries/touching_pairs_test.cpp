// `touching_pairs` against every pair, one by one.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "math/triangle_pair.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_pairs.hpp"
#include "support/targets.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;
using workbench::Solid;

// The corners as the contract says they are moved: in double precision, then rounded once.
Triangle moved(const Transform& transform, const Triangle& t) {
  Triangle to;
  const Vec3f* const from[] = {&t.v0, &t.v1, &t.v2};
  Vec3f* const where[] = {&to.v0, &to.v1, &to.v2};
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 3; ++i) {
      const auto& row = transform.rows[i];
      double sum = row[0] * from[k]->x;
      sum += row[1] * from[k]->y;
      sum += row[2] * from[k]->z;
      sum += row[3];
      (*where[k])[i] = static_cast<float>(sum);
    }
  }
  return to;
}

template <class Touch>
std::vector<TouchingPair> brute_force(const std::vector<Triangle>& first, const std::vector<Triangle>& second,
                                      const Transform& transform, const Touch& touch) {
  std::vector<TouchingPair> pairs;
  for (std::uint32_t a = 0; a < first.size(); ++a)
    for (std::uint32_t b = 0; b < second.size(); ++b)
      if (touch(first[a], moved(transform, second[b]))) pairs.push_back({{a, 0}, {b, 0}});
  return pairs;
}

Transform turned(std::mt19937& random, float shift) {
  // A rotation from a random quaternion.
  double q[4], length = 0;
  for (double& x : q) x = uniform(random, -1, 1), length += x * x;
  for (double& x : q) x /= std::sqrt(length);
  const auto [w, x, y, z] = std::tuple(q[0], q[1], q[2], q[3]);
  const Vec3f to = uniform_point(random, shift);
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), to.x},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), to.y},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), to.z}}};
}

TEST(TouchingPairs, AreThoseOfRationalArithmeticOnAGrid) {
  std::mt19937 random(1);
  for (int round = 0; round < 6; ++round) {
    const Soup first = soup(25, [&] { return grid_point(random, 2); }),
               second = soup(25, [&] { return grid_point(random, 2); });
    Transform transform;  // whole numbers, so that everything stays aligned
    if (round % 2 == 1) transform = {{{0, -1, 0, 1}, {1, 0, 0, 0}, {0, 0, 1, round - 3.0}}};
    const std::vector<TouchingPair> expected =
        brute_force(first.triangles, second.triangles, transform, exact::touch);
    EXPECT_GT(expected.size(), 5u);
    kerf_tests::for_each_target([&](const Target&) {
      const Bvh a = build(first.mesh(), spatial_splits_everywhere()),
                b = build(second.mesh(), spatial_splits_everywhere());
      EXPECT_EQ(a.touching_pairs(b, transform), expected);
    });
  }
}

TEST(TouchingPairs, AreThoseOfEveryPairWhereverTheSecondIsMoved) {
  std::mt19937 random(2);
  const Solid torus = workbench::make_torus(16, 8), sphere = workbench::make_sphere(2, 0.6f);
  const auto triangles = [](const Solid& solid) {
    std::vector<Triangle> all;
    for (const auto& [a, b, c] : solid.triangles)
      all.push_back({solid.vertices[a], solid.vertices[b], solid.vertices[c]});
    return all;
  };
  const std::vector<Triangle> first = triangles(torus), second = triangles(sphere);
  const Bvh a = build(torus.mesh(), spatial_splits_everywhere()),
            b = build(sphere.mesh(), spatial_splits_everywhere());
  std::size_t pairs = 0;
  for (int round = 0; round < 12; ++round) {
    const Transform transform = turned(random, 1.5f);
    const std::vector<TouchingPair> expected = brute_force(first, second, transform, triangles_touch);
    ASSERT_EQ(a.touching_pairs(b, transform), expected);
    ASSERT_EQ(a.touching_pairs(b, transform, {.threads = 1}), expected);
    ASSERT_EQ(a.touches(b, transform), !expected.empty());
    pairs += expected.size();
  }
  EXPECT_GT(pairs, 100u);
}

TEST(TouchingPairs, ACubeOnACubeTouchesWithAWholeFace) {
  const Bvh cube = build(workbench::make_box({0, 0, 0}, {1, 1, 1}).mesh());
  const auto along_x = [](double shift) { return Transform{{{1, 0, 0, shift}, {0, 1, 0, 0}, {0, 0, 1, 0}}}; };
  EXPECT_TRUE(cube.touches(cube, along_x(1)));
  EXPECT_FALSE(cube.touches(cube, along_x(1 + 1e-6)));
  EXPECT_TRUE(cube.touches(cube, along_x(1 - 1e-6)));
  EXPECT_FALSE(cube.touches(build(workbench::make_box({0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f}).mesh())))
      << "surfaces, not solids";
}

TEST(TouchingPairs, AMeshThatIsFlattenedCountsAsThePointsThatItHas) {
  const Bvh cube = build(workbench::make_box({0, 0, 0}, {1, 1, 1}).mesh());
  const Bvh other = build(workbench::make_sphere(1).mesh());
  const auto to_point = [](double x) { return Transform{{{0, 0, 0, x}, {0, 0, 0, 0.5}, {0, 0, 0, 0.5}}}; };
  EXPECT_TRUE(cube.touches(other, to_point(1)));
  EXPECT_FALSE(cube.touches(other, to_point(0.5)));
  const Transform to_segment{{{1, 0, 0, 0}, {0, 0, 0, 0.5}, {0, 0, 0, 0.25}}};  // from -1 to 1
  EXPECT_TRUE(cube.touches(other, to_segment));
}

TEST(TouchingPairs, NameTheMeshesOfBoth) {
  const Solid left = workbench::make_box({0, 0, 0}, {1, 1, 1}),
              right = workbench::make_box({9, 0, 0}, {10, 1, 1});
  const TriangleMesh meshes[] = {left.mesh(), right.mesh()};
  const Bvh both = build(meshes),
            one = build(workbench::make_box({9.5f, 0.2f, 0.2f}, {12, 0.8f, 0.8f}).mesh());
  const std::vector<TouchingPair> pairs = both.touching_pairs(one);
  ASSERT_FALSE(pairs.empty());
  for (const TouchingPair& pair : pairs) {
    EXPECT_EQ(pair.first.mesh, 1u);
    EXPECT_LT(pair.first.primitive, 12u);
    EXPECT_EQ(pair.second.mesh, 0u);
  }
}

TEST(TouchingPairs, ATransformOutOfRangeIsRefused) {
  const Bvh cube = build(workbench::make_box({0, 0, 0}, {1, 1, 1}).mesh());
  for (const double number :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e38, 1e300}) {
    Transform transform;
    transform.rows[1][1] = number;
    EXPECT_THROW((void)cube.touches(cube, transform), Error);
    EXPECT_THROW((void)cube.touching_pairs(cube, transform), Error);
  }
  EXPECT_FALSE(cube.touches(Bvh()));
  EXPECT_FALSE(Bvh().touches(cube));
}

}  // namespace
}  // namespace kerf
