// Tracing a set of rays: once to count, many times to time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <kerf/bvh.hpp>

#include "workbench/rays/rays.hpp"

namespace workbench {

/// What a counted pass over a set found. A hit of an any-hit ray keeps nothing but that it is one.
struct CountedPass {
  std::vector<kerf::Hit> hits;
  std::size_t hit_count = 0;
  std::size_t steps = 0;
  std::size_t triangle_tests = 0;
};

CountedPass trace_counted(const kerf::Bvh& bvh, const RaySet& set, unsigned threads);

struct TimingOptions {
  unsigned rounds = 3;   ///< at least
  double seconds = 1.0;  ///< go on until all passes together took this long
};

/// Seconds that each hierarchy takes for the set, ray by ray through the public calls, on one thread.
///
/// The hierarchies take turns, round after round. The set is cut into slices, and the time of a hierarchy is
/// the sum of the best times of its slices: a disturbance of the machine must then hit the same slice in
/// every round to show.
std::vector<double> time_interleaved(std::span<const kerf::Bvh> hierarchies, const RaySet& set,
                                     const TimingOptions& options);

}  // namespace workbench
