#include "workbench/compare/trace.hpp"

#include <algorithm>
#include <atomic>

#include <kerf/inspect.hpp>

#include "workbench/base/parallel.hpp"

namespace workbench {
namespace {

// Rays per task: four tiles of 8 by 8 pixels.
constexpr std::size_t grain = 256;

// With 200,000 rays, at some millions per second, a slice takes less than a millisecond. That is shorter than
// the time slices in which a busy system schedules threads: docs/decisions/0060 has the spread for other
// numbers.
constexpr std::size_t slice_count = 128;

// The hits are written to memory, so that no compiler may leave the tracing out.
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
  std::atomic<std::size_t> steps = 0, triangle_tests = 0, leaf_visits = 0;
  const auto trace_block = [&](std::size_t begin, std::size_t end) {
    kerf::TraversalCounters counters;
    for (std::size_t i = begin; i < end; ++i) {
      if (set.any_hit()) {
        if (occluded(bvh, set.rays[i], counters)) pass.hits[i].primitive = 0;
      } else {
        pass.hits[i] = intersect(bvh, set.rays[i], counters).value_or(kerf::Hit{});
      }
    }
    steps += counters.steps;
    triangle_tests += counters.triangle_tests;
    leaf_visits += counters.leaves;
  };
  on_threads(threads, [&] { parallel_for_blocks(set.rays.size(), grain, trace_block); });
  pass.steps = steps;
  pass.triangle_tests = triangle_tests;
  pass.leaf_visits = leaf_visits;
  pass.hit_count = static_cast<std::size_t>(std::count_if(
      pass.hits.begin(), pass.hits.end(), [](const kerf::Hit& hit) { return static_cast<bool>(hit); }));
  return pass;
}

std::vector<SliceTimes> time_hierarchies(std::span<const kerf::Bvh> hierarchies, const RaySet& set,
                                         const TimingOptions& options) {
  std::vector<kerf::Hit> hits(set.rays.size());
  std::vector<TraceRange> tracers;
  for (const kerf::Bvh& bvh : hierarchies) {
    tracers.push_back([&](std::size_t begin, std::size_t end) { trace(bvh, set, begin, end, hits); });
  }
  return time_slices(tracers, set.rays.size(), slice_count, options);
}

}  // namespace workbench
