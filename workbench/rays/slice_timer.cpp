#include "workbench/rays/slice_timer.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <numeric>

namespace workbench {

std::vector<double> time_slices(std::span<const TraceRange> tracers, std::size_t ray_count,
                                std::size_t slice_count, const TimingOptions& options) {
  if (ray_count == 0) return std::vector<double>(tracers.size(), 0.0);
  using Clock = std::chrono::steady_clock;
  const std::vector<double> untimed(slice_count, std::numeric_limits<double>::infinity());
  std::vector<std::vector<double>> best(tracers.size(), untimed);

  double spent = 0.0;
  for (unsigned round = 0; round < options.rounds || spent < options.seconds; ++round) {
    for (std::size_t t = 0; t < tracers.size(); ++t) {
      for (std::size_t slice = 0; slice < slice_count; ++slice) {
        const std::size_t begin = ray_count * slice / slice_count;
        const std::size_t end = ray_count * (slice + 1) / slice_count;
        const auto start = Clock::now();
        tracers[t](begin, end);
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        best[t][slice] = std::min(best[t][slice], seconds);
        spent += seconds;
      }
    }
  }

  std::vector<double> sums;
  for (const auto& slices : best) sums.push_back(std::accumulate(slices.begin(), slices.end(), 0.0));
  return sums;
}

}  // namespace workbench
