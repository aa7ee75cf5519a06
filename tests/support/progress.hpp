// What every build owes a caller who asks how far it is.
#pragma once

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/build.hpp>
#include <kerf/error.hpp>

namespace kerf_tests {

/// Expects that a build tells fractions that never fall and end at 1 at most, and that it is cancelled by a
/// false at its last word. Returns that word.
inline float expect_progress_and_cancelling(const kerf::TriangleMesh& mesh, kerf::BuildOptions options) {
  std::vector<float> told;
  options.progress = [&](float fraction) {
    told.push_back(fraction);
    return true;
  };
  (void)kerf::build(mesh, options);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_LE(told.back(), 1.0f);
  const float last = told.back();
  options.progress = [&](float fraction) { return fraction < last; };
  try {
    (void)kerf::build(mesh, options);
    ADD_FAILURE() << "was not cancelled";
  } catch (const kerf::Error& error) {
    EXPECT_EQ(error.code(), kerf::Error::cancelled);
  }
  return last;
}

}  // namespace kerf_tests
