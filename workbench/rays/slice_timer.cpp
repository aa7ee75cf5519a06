#include "workbench/rays/slice_timer.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <numeric>

namespace workbench {

std::vector<SliceTimes> time_slices(std::span<const TraceRange> tracers, std::size_t ray_count,
                                    std::size_t slice_count, const TimingOptions& options) {
  if (ray_count == 0) return std::vector<SliceTimes>(tracers.size());
  using Clock = std::chrono::steady_clock;
  const std::vector<double> untimed(slice_count, std::numeric_limits<double>::infinity());
  std::vector<std::vector<double>> best(tracers.size(), untimed), rounds(tracers.size());

  double spent = 0.0;
  for (unsigned round = 0; round < options.rounds || spent < options.seconds; ++round) {
    for (std::size_t t = 0; t < tracers.size(); ++t) {
      double of_round = 0.0;
      for (std::size_t slice = 0; slice < slice_count; ++slice) {
        const std::size_t begin = ray_count * slice / slice_count;
        const std::size_t end = ray_count * (slice + 1) / slice_count;
        const auto start = Clock::now();
        tracers[t](begin, end);
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        best[t][slice] = std::min(best[t][slice], seconds);
        of_round += seconds;
      }
      rounds[t].push_back(of_round);
      spent += of_round;
    }
  }

  std::vector<SliceTimes> times;
  for (std::size_t t = 0; t < tracers.size(); ++t) {
    const auto middle = rounds[t].begin() + static_cast<std::ptrdiff_t>(rounds[t].size() / 2);
    std::nth_element(rounds[t].begin(), middle, rounds[t].end());
    times.push_back({std::accumulate(best[t].begin(), best[t].end(), 0.0), *middle});
  }
  return times;
}

}  // namespace workbench
