#include "tree/measures/lcv.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "construction/construct.hpp"
#include "tree/measures/sample_trees.hpp"

namespace kerf {
namespace {

TEST(Lcv, OfTwoHalvesFollowsFromTheirAreas) {
  // A line through a convex box meets a convex part of it with the ratio of the areas as probability, here
  // 2/3. It meets at least one of the two, and so it meets both with probability 1/3.
  EXPECT_NEAR(leaf_count_variability(TwoHalves().tree), std::sqrt(1.0 / 3.0 * 2.0 / 3.0), 2e-3);
}

TEST(Lcv, IsTheSameForAnyNumberOfThreads) {
  const Soup soup = random_soup(3000, 0.1f, 3);
  const TriangleMesh mesh = soup.mesh();
  const BinaryTree tree = construct(Geometry({&mesh, 1}), {});
  const double variability = leaf_count_variability(tree);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(leaf_count_variability(tree), variability);
}

TEST(Lcv, OfAnEmptyTreeIsZero) {
  EXPECT_EQ(leaf_count_variability(BinaryTree{}), 0.0);
}

}  // namespace
}  // namespace kerf
