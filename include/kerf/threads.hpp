// Threads of the caller's own.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <functional>

#include <kerf/export.hpp>

namespace kerf {

/// A pool of threads that the caller has already, in two functions. Both may be called from any thread, and
/// from several at once.
struct ThreadPool {
  /// How many threads may work on one call, that which makes the call included.
  std::function<unsigned()> threads;

  /// Has `task()` called once, on any thread of the pool, now or later: at the latest before the pool ends.
  /// `task` never throws, ends when there is nothing to help with, and waits for nobody but for what other
  /// threads are in the midst of. If this throws, those threads that there are do the work.
  std::function<void(std::function<void()> task)> start;
};

/// Calls `work`, and runs all calls of kerf that it makes on this thread and those of `pool`, instead of on
/// the threads that the library was built for (KERF_THREADS). Answers are the same. `threads` of options
/// limits them further. A call never waits for a task that the pool has not begun, so that it may be made
/// from a thread of the pool, and with all threads of the pool busy. What `work` throws is passed on. `pool`
/// has to live until this returns. Throws `Error::invalid_argument` if one of its functions is missing.
KERF_API void run_on(const ThreadPool& pool, const std::function<void()>& work);

}  // namespace kerf

#endif  // KERF_HAS_CPP20
