// Many rays, divided among threads.
#pragma once

#include <algorithm>
#include <cstddef>

#include "base/parallel.hpp"
#include "traversal/rays/batch.hpp"

namespace kerf {

/// Calls `trace(begin, count)` for batches of rays that together are `0 .. count - 1`, on all threads of the
/// caller's arena.
template <class Trace>
void for_each_batch(std::size_t count, const Trace& trace) {
  isolated([&] {
    parallel_for_ranges(std::size_t{0}, count, rays_per_batch, [&](const auto& range) {
      for (std::size_t begin = range.begin(); begin < range.end(); begin += rays_per_batch) {
        trace(begin, std::min(rays_per_batch, range.end() - begin));
      }
    });
  });
}

}  // namespace kerf
