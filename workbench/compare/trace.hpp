// Tracing a set of rays through hierarchies: once to count, many times to measure the time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <kerf/bvh.hpp>

#include "workbench/rays/rays.hpp"
#include "workbench/rays/slice_timer.hpp"

namespace workbench {

/// What a counted pass over a set found. Of the hit of an any-hit ray only its existence is known.
struct CountedPass {
  std::vector<kerf::Hit> hits;
  std::size_t hit_count = 0;
  std::size_t steps = 0;
  std::size_t triangle_tests = 0;
  std::size_t leaf_visits = 0;
};

/// Traces `set` on `threads` threads, 0 for all there are, counting as it goes.
CountedPass trace_counted(const kerf::Bvh& bvh, const RaySet& set, unsigned threads);

/// The seconds that each hierarchy takes for the set, interleaved with the others (see `time_slices`): ray by
/// ray through the public calls, on one thread.
std::vector<SliceTimes> time_hierarchies(std::span<const kerf::Bvh> hierarchies, const RaySet& set,
                                         const TimingOptions& options);

}  // namespace workbench
