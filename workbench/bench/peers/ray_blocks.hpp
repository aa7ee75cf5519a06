// The loop over many single rays, for engines that have none.
#pragma once

#include <cstddef>

#include "workbench/base/parallel.hpp"

namespace workbench {

/// Calls `trace(begin, end)` for all of `count` rays: once if `threads` is 1, else in blocks, on all threads
/// that oneTBB may use.
template <class Trace>
void for_ray_blocks(unsigned threads, std::size_t count, const Trace& trace) {
  // Four tiles of 8 by 8 pixels take some 20 microseconds, far longer than it takes to start a task.
  constexpr std::size_t block = 256;
  if (threads == 1) return trace(std::size_t{0}, count);
  parallel_for_blocks(count, block, trace);
}

}  // namespace workbench
