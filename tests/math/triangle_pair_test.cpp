// `triangles_touch` against rational arithmetic.
#include "math/triangle_pair.hpp"

#include <random>

#include <gtest/gtest.h>

#include "support/adversarial.hpp"
#include "support/exact_pairs.hpp"
#include "support/instrumented.hpp"

namespace kerf {
namespace {

using namespace adversarial;

// A second triangle that is hard for the first: it shares a corner, has a corner on an edge or inside, lies
// in its plane, or is as it comes.
Triangle other_triangle(std::mt19937& random, const Triangle& t, int half) {
  const auto point = [&] { return grid_point(random, half); };
  switch (random() % 5) {
    case 0:
      return {t.v1, point(), point()};
    case 1:
      return {0.5f * (t.v0 + t.v1), point(), point()};
    case 2:
      return {0.25f * t.v0 + 0.25f * t.v1 + 0.5f * t.v2, point(), point()};
    case 3: {
      const Vec3f u = t.v1 - t.v0, v = t.v2 - t.v0;
      const auto in_plane = [&] {
        return t.v0 + static_cast<float>(static_cast<int>(random() % 7) - 3) * 0.5f * u +
               static_cast<float>(static_cast<int>(random() % 7) - 3) * 0.5f * v;
      };
      const Vec3f a = in_plane(), b = in_plane(), c = in_plane();
      return {a, b, c};
    }
    default:
      return {point(), point(), point()};
  }
}

TEST(TrianglePair, AgreesWithRationalArithmeticOnAGrid) {
  std::mt19937 random(1);
  int touching = 0, apart = 0, flat = 0;
  const int rounds = static_cast<int>(test::reduced(6000));
  for (int i = 0; i < rounds; ++i) {
    const int half = 1 + i % 3;
    const Triangle first{grid_point(random, half), grid_point(random, half), grid_point(random, half)};
    if (is_degenerate(first)) continue;
    const Triangle second = other_triangle(random, first, half);
    const bool expected = exact::touch(first, second);
    ASSERT_EQ(triangles_touch(first, second), expected) << "round " << i;
    if (is_degenerate(second)) {
      ++flat;
    } else {
      ASSERT_EQ(triangles_touch(second, first), expected) << "round " << i;
    }
    ++(expected ? touching : apart);
  }
  EXPECT_GT(touching, rounds / 10);
  EXPECT_GT(apart, rounds / 10);
  EXPECT_GT(flat, rounds / 100);
}

TEST(TrianglePair, IsExactWhereDoublePrecisionIsNot) {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const float far = 1 << 20;
    const auto point = [&] { return Vec3f{far, far, far} + uniform_point(random, 1.0f); };
    const Triangle first{point(), point(), point()};
    if (is_degenerate(first)) continue;
    // Beside a corner, an edge and the inside by as little as floats allow.
    const Vec3f near = i % 3 == 0   ? first.v0
                       : i % 3 == 1 ? 0.5f * (first.v0 + first.v1)
                                    : 0.25f * first.v0 + 0.25f * first.v1 + 0.5f * first.v2;
    const Triangle second{near, point(), point()};
    ASSERT_EQ(triangles_touch(first, second), exact::touch(first, second)) << "round " << i;
  }
}

}  // namespace
}  // namespace kerf
