#include "tree/measures/sah.hpp"

#include <gtest/gtest.h>

#include "tree/measures/sample_trees.hpp"

namespace kerf {
namespace {

TEST(Sah, OfTwoHalvesIsThatByHand) {
  EXPECT_DOUBLE_EQ(surface_area_cost(TwoHalves().tree), 1.2 + 2.0 * 4.0 / 6.0);
}

TEST(Sah, OfAnEmptyTreeIsZero) {
  EXPECT_EQ(surface_area_cost(BinaryTree{}), 0.0);
}

}  // namespace
}  // namespace kerf
