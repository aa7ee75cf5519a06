#include "workbench/compare/trace.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <numeric>

#include "stages.hpp"
#include "workbench/base/parallel.hpp"

namespace workbench {
namespace {

using Clock = std::chrono::steady_clock;

// Rays that a thread takes at once: four tiles of 8 by 8 pixels.
constexpr std::size_t grain = 256;

// Into how many slices a set is cut for timing. At 200,000 rays and some million a second a slice takes less
// than a millisecond, shorter than the spans for which a busy system lets a thread run: docs/decisions/0060
// has the spread of results for other numbers.
constexpr std::size_t slice_count = 128;

// The hits end up in memory, so that no compiler may leave the tracing out.
void trace(const kerf::Bvh& bvh, const RaySet& set, std::size_t begin, std::size_t end,
           std::span<kerf::Hit> hits) {
  if (set.any_hit()) {
    for (std::size_t i = begin; i < end; ++i)
      hits[i].primitive = bvh.occluded(set.rays[i]) ? 0 : kerf::invalid_id;
  } else {
    for (std::size_t i = begin; i < end; ++i) hits[i] = bvh.intersect(set.rays[i]).value_or(kerf::Hit{});
  }
}

}  // namespace

CountedPass trace_counted(const kerf::Bvh& bvh, const RaySet& set, unsigned threads) {
  CountedPass pass{.hits = std::vector<kerf::Hit>(set.rays.size())};
  std::atomic<std::size_t> steps = 0, triangle_tests = 0;
  const auto trace_block = [&](std::size_t begin, std::size_t end) {
    kerf::TraversalCounters counters;
    for (std::size_t i = begin; i < end; ++i) {
      if (set.any_hit()) {
        if (occluded_counted(bvh, set.rays[i], counters)) pass.hits[i].primitive = 0;
      } else {
        pass.hits[i] = intersect_counted(bvh, set.rays[i], counters).value_or(kerf::Hit{});
      }
    }
    steps += counters.steps;
    triangle_tests += counters.triangle_tests;
  };
  on_threads(threads, [&] { parallel_for_blocks(set.rays.size(), grain, trace_block); });
  pass.steps = steps;
  pass.triangle_tests = triangle_tests;
  pass.hit_count = static_cast<std::size_t>(std::count_if(
      pass.hits.begin(), pass.hits.end(), [](const kerf::Hit& hit) { return static_cast<bool>(hit); }));
  return pass;
}

std::vector<double> time_interleaved(std::span<const kerf::Bvh> hierarchies, const RaySet& set,
                                     const TimingOptions& options) {
  using Slices = std::array<double, slice_count>;
  Slices untimed;
  untimed.fill(std::numeric_limits<double>::infinity());
  std::vector<Slices> best(hierarchies.size(), untimed);
  std::vector<kerf::Hit> hits(set.rays.size());

  double spent = 0.0;
  for (unsigned round = 0; round < options.rounds || spent < options.seconds; ++round) {
    const auto round_start = Clock::now();
    for (std::size_t h = 0; h < hierarchies.size(); ++h) {
      for (std::size_t slice = 0; slice < slice_count; ++slice) {
        const std::size_t begin = set.rays.size() * slice / slice_count;
        const std::size_t end = set.rays.size() * (slice + 1) / slice_count;
        const auto start = Clock::now();
        trace(hierarchies[h], set, begin, end, hits);
        best[h][slice] =
            std::min(best[h][slice], std::chrono::duration<double>(Clock::now() - start).count());
      }
    }
    spent += std::chrono::duration<double>(Clock::now() - round_start).count();
  }

  std::vector<double> seconds;
  for (const Slices& slices : best) seconds.push_back(std::accumulate(slices.begin(), slices.end(), 0.0));
  return seconds;
}

}  // namespace workbench
