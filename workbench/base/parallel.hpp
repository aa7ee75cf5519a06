// Loops over the threads of oneTBB. Every task computes in the default floating-point environment, whatever
// the thread that first used oneTBB was set to.
//
// ThreadSanitizer sees synchronisation only in code that was compiled with it, and the packaged oneTBB was
// not. Under ThreadSanitizer the same loops therefore run on threads of the standard library.
#pragma once

#include <algorithm>
#include <cfenv>
#include <cstddef>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define WORKBENCH_STANDARD_THREADS
#endif
#endif
#if defined(__SANITIZE_THREAD__)
#define WORKBENCH_STANDARD_THREADS
#endif

#ifdef WORKBENCH_STANDARD_THREADS
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#endif

namespace workbench {

/// Rounding to nearest and denormals in this thread, as long as it lives.
class DefaultFloatingPoint {
 public:
  DefaultFloatingPoint() {
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~DefaultFloatingPoint() { std::fesetenv(&before_); }
  DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
  DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

 private:
  std::fenv_t before_;
};

#ifdef WORKBENCH_STANDARD_THREADS

/// Calls `body(begin, end)` for blocks of up to `grain` that together make up `0 .. count - 1`.
template <class Body>
void parallel_for_blocks(std::size_t count, std::size_t grain, const Body& body) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto work = [&] {
    const DefaultFloatingPoint plain;
    try {
      for (std::size_t begin = next.fetch_add(grain); begin < count; begin = next.fetch_add(grain)) {
        body(begin, std::min(begin + grain, count));
      }
    } catch (...) {
      const std::lock_guard lock(error_mutex);
      error = std::current_exception();
    }
  };
  {
    const std::jthread other(work);
    work();
  }
  if (error) std::rethrow_exception(error);
}

/// Calls `work` on `threads` threads, 0 for all there are.
template <class Work>
void on_threads(unsigned, const Work& work) {
  work();
}

/// Threads that a loop which begins here may run on.
inline std::size_t thread_count() {
  return 2;
}

#else

/// Calls `body(begin, end)` for blocks of up to `grain` that together make up `0 .. count - 1`.
template <class Body>
void parallel_for_blocks(std::size_t count, std::size_t grain, const Body& body) {
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_for(Range(0, count, grain), [&](const Range& range) {
    const DefaultFloatingPoint plain;
    body(range.begin(), range.end());
  });
}

/// Calls `work` on `threads` threads, 0 for all there are. Asking oneTBB for more than it may have is an
/// error.
template <class Work>
void on_threads(unsigned threads, const Work& work) {
  const auto available =
      static_cast<unsigned>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  tbb::task_arena arena(static_cast<int>(threads == 0 ? available : std::min(threads, available)));
  arena.execute(work);
}

/// Threads that a loop which begins here may run on.
inline std::size_t thread_count() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

#endif

/// Calls `body(i)` for every i of `0 .. count - 1`.
template <class Body>
void parallel_for(std::size_t count, const Body& body) {
  parallel_for_blocks(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace workbench
