#include "workbench/rays/slice_timer.hpp"

#include <gtest/gtest.h>

namespace workbench {
namespace {

TEST(SliceTimer, EveryTracerTracesEveryRayOncePerRoundInRotation) {
  constexpr std::size_t rays = 103, slices = 10;
  constexpr unsigned rounds = 3;
  std::vector<std::vector<unsigned>> traced(2, std::vector<unsigned>(rays, 0));
  std::vector<TraceRange> tracers;
  for (std::size_t t = 0; t < 2; ++t) {
    tracers.push_back([&traced, t](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        EXPECT_EQ(traced[t][i], traced[0][i] - t) << "the first tracer is a round ahead, or none";
        ++traced[t][i];
      }
    });
  }
  const std::vector<SliceTimes> times =
      time_slices(tracers, rays, slices, {.rounds = rounds, .seconds = 0.0});
  ASSERT_EQ(times.size(), 2u);
  for (std::size_t t = 0; t < 2; ++t) {
    EXPECT_EQ(traced[t], std::vector<unsigned>(rays, rounds));
    EXPECT_GT(times[t].seconds, 0.0);
    EXPECT_GE(times[t].median_round, times[t].seconds) << "no round is faster than the best of all slices";
  }
}

TEST(SliceTimer, NoRaysTakeNoTime) {
  const std::vector<TraceRange> tracers{[](std::size_t, std::size_t) { FAIL() << "there are no rays"; }};
  EXPECT_EQ(time_slices(tracers, 0, 8, {.rounds = 3, .seconds = 1.0})[0].seconds, 0.0);
}

}  // namespace
}  // namespace workbench
