// Many rays, each on its own: the loop that engines without one are given.
#pragma once

#include <cstddef>

#include "workbench/base/parallel.hpp"

namespace workbench {

/// Calls `trace(begin, end)` for all of `count` rays: once with one thread, else in blocks, from several
/// threads.
template <class Trace>
void for_ray_blocks(unsigned threads, std::size_t count, const Trace& trace) {
  // Four tiles of 8 by 8 pixels: some 20 microseconds, far more than it costs to hand out a task.
  constexpr std::size_t block = 256;
  if (threads == 1) return trace(std::size_t{0}, count);
  parallel_for_blocks(count, block, trace);
}

}  // namespace workbench
