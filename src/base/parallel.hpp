// Loops over threads. They run on oneTBB, whose threads have the floating-point modes of the thread that used
// it first; tasks here have the default modes.
//
// ThreadSanitizer sees synchronisation only in code that was compiled with it, and the packaged oneTBB was
// not: every task would seem to race with its parent. In ThreadSanitizer's builds the same tasks run on
// threads of the standard library, which it understands, so that each report is a race between tasks.
#pragma once

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "base/fp_environment.hpp"

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define KERF_STANDARD_THREADS
#endif
#endif
#if defined(__SANITIZE_THREAD__)
#define KERF_STANDARD_THREADS
#endif

#ifdef KERF_STANDARD_THREADS
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#else
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#endif

namespace kerf {

/// The number of threads that work where `wanted` are asked for; 0 asks for all. oneTBB never has more than
/// its `max_allowed_parallelism`, and prints a warning if more are asked for.
inline int usable_threads(unsigned wanted) {
  const auto available =
      static_cast<unsigned>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  return static_cast<int>(wanted == 0 ? available : std::min(wanted, available));
}

/// True while the work of this thread is to run on this thread only.
inline thread_local bool one_thread_only = false;

/// Calls `work` and returns what it returns. Loops in it stay on this thread and never enter the scheduler.
template <class Work>
auto on_this_thread(const Work& work) {
  struct Restore {
    bool before = one_thread_only;
    ~Restore() { one_thread_only = before; }
  } restore;
  one_thread_only = true;
  return work();
}

#ifdef KERF_STANDARD_THREADS

/// Calls `body` with ranges (`begin()`, `end()`) that together make up `begin .. end - 1`, of about `grain`.
template <class Index, class Body>
void parallel_for_ranges(Index begin, Index end, std::size_t grain, const Body& body) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto size = static_cast<std::size_t>(end - begin);
  const auto work = [&] {
    const PlainFloatingPoint plain;
    try {
      for (std::size_t at = next.fetch_add(grain); at < size; at = next.fetch_add(grain)) {
        body(tbb::blocked_range<Index>(static_cast<Index>(begin + at),
                                       static_cast<Index>(begin + std::min(at + grain, size))));
      }
    } catch (...) {
      const std::lock_guard lock(error_mutex);
      error = std::current_exception();
    }
  };
  if (one_thread_only) {
    work();
  } else {
    std::thread other(work);  // neither call of `work` throws
    work();
    other.join();
  }
  if (error) std::rethrow_exception(error);
}

/// Calls `body(i)` for every i of `0 .. count - 1`.
template <class Index, class Body>
void parallel_for(Index count, const Body& body) {
  parallel_for_ranges(Index{0}, count, 1, [&](const auto& range) {
    for (Index i = range.begin(); i != range.end(); ++i) body(i);
  });
}

/// The sum of `body(range)` over ranges of `0 .. count - 1`, which are divided and added up in the same way
/// on any number of threads.
template <class Sum, class Index, class Body>
Sum parallel_sum(Index count, std::size_t grain, const Body& body) {
  std::vector<Sum> sums((static_cast<std::size_t>(count) + grain - 1) / grain);
  parallel_for_ranges(Index{0}, count, grain,
                      [&](const auto& range) { sums[range.begin() / grain] = body(range); });
  Sum sum{};
  for (const Sum& other : sums) sum = sum + other;
  return sum;
}

/// Calls both, possibly at the same time.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  parallel_for(2, [&](int i) { i == 0 ? first() : second(); });
}

/// Calls `work` and returns what it returns.
template <class Work>
auto isolated(const Work& work) {
  return work();
}

/// Calls `work` on `wanted` threads, 0 for all, and returns what it returns.
template <class Work>
auto on_threads(unsigned wanted, const Work& work) {
  if (usable_threads(wanted) == 1) return on_this_thread(work);
  return work();
}

#else

/// Calls `body` with ranges (`begin()`, `end()`) that together make up `begin .. end - 1`, of about `grain`.
template <class Index, class Body>
void parallel_for_ranges(Index begin, Index end, std::size_t grain, const Body& body) {
  if (one_thread_only) {
    const PlainFloatingPoint plain;
    for (Index at = begin; at < end;) {
      const Index next = static_cast<std::size_t>(end - at) > grain ? static_cast<Index>(at + grain) : end;
      body(tbb::blocked_range<Index>(at, next));
      at = next;
    }
    return;
  }
  tbb::parallel_for(tbb::blocked_range<Index>(begin, end, grain),
                    [&](const tbb::blocked_range<Index>& range) {
                      const PlainFloatingPoint plain;
                      body(range);
                    });
}

/// Calls `body(i)` for every i of `0 .. count - 1`.
template <class Index, class Body>
void parallel_for(Index count, const Body& body) {
  if (one_thread_only || count <= 1) {
    const PlainFloatingPoint plain;
    for (Index i = 0; i < count; ++i) body(i);
    return;
  }
  tbb::parallel_for(Index{0}, count, [&](Index i) {
    const PlainFloatingPoint plain;
    body(i);
  });
}

/// As `tbb::parallel_deterministic_reduce` divides a range and adds up, on this thread.
template <class Range, class Sum, class Body>
Sum sum_in_halves(Range left, const Sum& zero, const Body& body) {
  if (!left.is_divisible()) return body(left, zero);
  const Range right(left, tbb::split());  // takes the upper half of `left`
  const Sum lower = sum_in_halves(left, zero, body);
  return lower + sum_in_halves(right, zero, body);
}

/// The sum of `body(range)` over ranges of `0 .. count - 1`, which are divided and added up in the same way
/// on any number of threads.
template <class Sum, class Index, class Body>
Sum parallel_sum(Index count, std::size_t grain, const Body& body) {
  const auto of_range = [&](const tbb::blocked_range<Index>& range, const Sum& sum) {
    const PlainFloatingPoint plain;
    return sum + body(range);
  };
  const tbb::blocked_range<Index> all(0, count, grain);
  if (one_thread_only) return sum_in_halves(all, Sum{}, of_range);
  return tbb::parallel_deterministic_reduce(all, Sum{}, of_range,
                                            [](const Sum& a, const Sum& b) { return a + b; });
}

/// Calls both, possibly at the same time.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  if (one_thread_only) {
    const PlainFloatingPoint plain;
    first();
    second();
    return;
  }
  const auto plainly = [](const auto& call) {
    return [&call] {
      const PlainFloatingPoint plain;
      call();
    };
  };
  tbb::parallel_invoke(plainly(first), plainly(second));
}

/// Calls `work` on the threads of the caller's arena, and returns what it returns. While `work` waits for its
/// own tasks this thread takes no others: a task of the caller would run in the middle of the one that
/// called, on the same thread, with the same thread-local data and locks.
template <class Work>
auto isolated(const Work& work) {
  if (one_thread_only) return work();
  return tbb::this_task_arena::isolate(work);
}

/// Calls `work` on `wanted` threads and returns what it returns; 0 stands for the threads of the caller's
/// arena. If that has as many as are wanted, `work` runs in it: entering another arena takes 70 microseconds.
/// One thread needs no arena at all.
template <class Work>
auto on_threads(unsigned wanted, const Work& work) {
  if (wanted == 0 || one_thread_only) return isolated(work);
  const int threads = usable_threads(wanted);
  if (threads == 1) return on_this_thread(work);
  if (tbb::this_task_arena::max_concurrency() == threads) return isolated(work);
  tbb::task_arena arena(threads);
  return arena.execute(work);
}

#endif

}  // namespace kerf
