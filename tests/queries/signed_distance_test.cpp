#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;

TEST(SignedDistance, OfABoxIsItsFormula) {
  const Bvh bvh = build(workbench::make_box({-1, -2, -3}, {1, 2, 3}, 3).mesh(), spatial_splits_everywhere());
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    const Vec3f p = i % 2 ? uniform_point(random, 4.0f) : grid_point(random, 4);
    const double qx = std::abs(double{p.x}) - 1, qy = std::abs(double{p.y}) - 2,
                 qz = std::abs(double{p.z}) - 3;
    const double outside = std::hypot(std::max(qx, 0.0), std::max(qy, 0.0), std::max(qz, 0.0));
    const double expected = outside + std::min(0.0, std::max({qx, qy, qz}));
    ASSERT_NEAR(bvh.signed_distance(p), expected, 1e-6);
    ASSERT_EQ(bvh.contains(p), expected <= 0.0);
  }
}

}  // namespace
}  // namespace kerf
