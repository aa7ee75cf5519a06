#include "math/ray_triangle.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace {

// Products of two floats are exact in double precision. Their difference is rounded once.
double exact(float a, float b, float c, float d) {
  return static_cast<double>(a) * b - static_cast<double>(c) * d;
}

}  // namespace

TEST(RayTriangle, HasTheExactSignAndTwoUnitsOfErrorHoweverMuchCancels) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  std::uniform_int_distribution<int> few(-3, 3);
  for (int i = 0; i < 200000; ++i) {
    const float a = uniform(random), b = uniform(random), c = uniform(random);
    float d = a * b / c;  // as near to cancelling as floats come, or a few steps from there
    for (int step = few(random); step != 0; step += step < 0 ? 1 : -1)
      d = std::nextafter(d, step < 0 ? -4.0f : 4.0f);
    const double expected = exact(a, b, c, d);
    if (std::abs(expected) < 0x1p-90) continue;
    ASSERT_NEAR(kerf::difference_of_products(a, b, c, d), expected, 0x1p-22 * std::abs(expected));
  }
}

TEST(RayTriangle, IsZeroWhereTheProductsAreEqual) {
  EXPECT_EQ(kerf::difference_of_products(3.0f, 0.7f, 0.7f, 3.0f), 0.0f);
  EXPECT_EQ(kerf::difference_of_products(0x1.8p0f, 0x1.555556p0f, 0x1.8p1f, 0x1.555556p-1f), 0.0f);
}
