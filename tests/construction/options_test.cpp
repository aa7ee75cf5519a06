#include "construction/options.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

namespace kerf {
namespace {

int code_of(const BuildOptions& options) {
  try {
    check_options(options);
  } catch (const Error& error) {
    return error.code();
  }
  return -1;
}

TEST(Options, DefaultsAreInTheirRanges) {
  EXPECT_EQ(code_of({}), -1);
}

TEST(Options, OutOfTheirRangesAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float alpha : {-0.1f, 1.5f, nan}) EXPECT_EQ(code_of({.alpha = alpha}), Error::invalid_argument);
  for (const float ratio : {0.5f, 17.0f, nan})
    EXPECT_EQ(code_of({.max_reference_ratio = ratio}), Error::invalid_argument);
  for (const std::uint32_t size : {0u, 9u})
    EXPECT_EQ(code_of({.max_leaf_size = size}), Error::invalid_argument);
  EXPECT_EQ(code_of({.non_finite = static_cast<NonFinite>(2)}), Error::invalid_argument);
  EXPECT_EQ(code_of({.quality = static_cast<Quality>(3)}), Error::invalid_argument);
  for (const double seconds : {-1.0, double{nan}})
    EXPECT_EQ(code_of({.max_refinement_seconds = seconds}), Error::invalid_argument);
  EXPECT_EQ(code_of({.builder = static_cast<Builder>(99)}), Error::invalid_argument);
}

// The public functions check them first.
TEST(Options, OutOfTheirRangesAreRefusedByEveryFunctionThatTakesThem) {
  const BuildOptions wrong{.alpha = 2.0f};
  EXPECT_THROW(build(TriangleMesh{}, wrong), Error);
  EXPECT_THROW(build_memory_bound(0, wrong), Error);
}

}  // namespace
}  // namespace kerf
