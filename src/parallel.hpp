// oneTBB's loops, as the library and its tools use them.
//
// ThreadSanitizer sees synchronisation only in code that was compiled with it. The packaged oneTBB was not,
// so that every task would seem to race with whoever spawned it. Here it is told what holds: all that
// happened before a loop began happens before each of its tasks, and all that a task did happens before the
// loop returns. What happens inside oneTBB itself cmake/tsan-suppressions.txt leaves out. In other builds
// nothing is added.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#if !defined(__SANITIZE_THREAD__) && defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define __SANITIZE_THREAD__
#endif
#endif

#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace kerf {

/// The two moments of a loop at which one thread's work is handed to others: its beginning and its end.
class LoopOrder {
 public:
  /// What a task does, in its order: after the loop's beginning, before its end, also if it throws.
  class InTask {
   public:
    explicit InTask(LoopOrder& order) : order_(order) { acquire(order_.begun_); }
    ~InTask() { release(order_.ended_); }
    InTask(const InTask&) = delete;
    InTask& operator=(const InTask&) = delete;

   private:
    LoopOrder& order_;
  };

  LoopOrder() { release(begun_); }
  ~LoopOrder() { acquire(ended_); }
  LoopOrder(const LoopOrder&) = delete;
  LoopOrder& operator=(const LoopOrder&) = delete;

 private:
#ifdef __SANITIZE_THREAD__
  static void acquire(char& moment) {
    __tsan_acquire(&moment);
  }
  static void release(char& moment) {
    __tsan_release(&moment);
  }
#else
  static void acquire(char&) {}
  static void release(char&) {}
#endif

  char begun_ = 0, ended_ = 0;
};

/// Calls `body(i)` for every i of `0 .. count - 1`.
template <class Index, class Body>
void parallel_for(Index count, const Body& body) {
  LoopOrder order;
  tbb::parallel_for(Index{0}, count, [&](Index i) {
    const LoopOrder::InTask in_task(order);
    body(i);
  });
}

/// Calls `body` with ranges (`begin()`, `end()`) that together make up `begin .. end - 1`, of about `grain`
/// or more.
template <class Index, class Body>
void parallel_for_ranges(Index begin, Index end, std::size_t grain, const Body& body) {
  LoopOrder order;
  tbb::parallel_for(tbb::blocked_range<Index>(begin, end, grain),
                    [&](const tbb::blocked_range<Index>& range) {
                      const LoopOrder::InTask in_task(order);
                      body(range);
                    });
}

/// The sum of `body(range)` over ranges of `0 .. count - 1`, parted and added up in the same way on any
/// number of threads.
template <class Sum, class Index, class Body>
Sum parallel_sum(Index count, std::size_t grain, const Body& body) {
  LoopOrder order;
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<Index>(0, count, grain), Sum{},
      [&](const tbb::blocked_range<Index>& range, const Sum& sum) {
        const LoopOrder::InTask in_task(order);
        return sum + body(range);
      },
      [&](const Sum& a, const Sum& b) {
        const LoopOrder::InTask in_task(order);
        return a + b;
      });
}

/// Calls both, perhaps at once.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  LoopOrder order;
  const auto call = [&order](const auto& work) {
    const LoopOrder::InTask in_task(order);
    work();
  };
  tbb::parallel_invoke([&] { call(first); }, [&] { call(second); });
}

/// Calls `work` in `arena` and returns what it returns.
template <class Work>
auto execute_in(tbb::task_arena& arena, const Work& work) {
  LoopOrder order;
  return arena.execute([&] {
    const LoopOrder::InTask in_task(order);
    return work();
  });
}

}  // namespace kerf
