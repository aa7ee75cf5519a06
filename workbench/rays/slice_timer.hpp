// How long tracers take for the same rays, measured so that disturbances of the machine do not count.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace workbench {

/// Traces the rays `begin .. end - 1` of the set that it was made for.
using TraceRange = std::function<void(std::size_t begin, std::size_t end)>;

struct TimingOptions {
  unsigned rounds = 3;   ///< at least
  double seconds = 1.0;  ///< more rounds follow until all tracers together traced for this long
};

/// How long one tracer took.
struct SliceTimes {
  double seconds = 0.0;       ///< the sum over the slices of the shortest time of each
  double median_round = 0.0;  ///< the middle one of the times of whole rounds, disturbances and all
};

/// The seconds that each of `tracers` takes for `ray_count` rays.
///
/// The set is cut into `slice_count` slices of equal size. In every round each tracer traces all of them, one
/// tracer after another. What counts is the sum over the slices of the shortest time of each: a
/// disturbance shows only if it hits the same slice in every round.
std::vector<SliceTimes> time_slices(std::span<const TraceRange> tracers, std::size_t ray_count,
                                    std::size_t slice_count, const TimingOptions& options);

}  // namespace workbench
