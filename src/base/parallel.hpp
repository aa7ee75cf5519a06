// Loops over threads. KERF_THREADS, an option of CMake, says whose these are:
//
//     tbb      oneTBB's, shared with whoever else uses it in the program
//     std      the standard library's, begun for each call that has work for several; KERF_STANDARD_THREADS
//     serial   the caller's alone; KERF_SERIAL
//
// Within `run_on` (<kerf/threads.hpp>) they are those of the caller's pool, whatever the option says.
//
// oneTBB's threads have the floating-point modes of the thread that used it first; tasks here have the
// default modes. ThreadSanitizer sees synchronisation only in code that was compiled with it, and the
// packaged oneTBB was not: every task would seem to race with its parent. So it needs `std`.
#pragma once

#include <algorithm>
#include <cstddef>

#include "base/fp_environment.hpp"
#include "base/team.hpp"

#if !defined(KERF_STANDARD_THREADS) && !defined(KERF_SERIAL)
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#endif

namespace kerf {

/// `begin() .. end() - 1`.
template <class Index>
class IndexRange {
 public:
  IndexRange(Index begin, Index end) : begin_(begin), end_(end) {}
  Index begin() const { return begin_; }
  Index end() const { return end_; }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }

 private:
  Index begin_, end_;
};

/// The number of threads that work where `wanted` are asked for; 0 asks for all. oneTBB never has more than
/// its `max_allowed_parallelism`, and prints a warning if more are asked for.
inline int usable_threads(unsigned wanted) {
#if defined(KERF_SERIAL)
  unsigned available = 1;
#elif defined(KERF_STANDARD_THREADS)
  unsigned available = std::max(1u, std::thread::hardware_concurrency());
#else
  auto available =
      static_cast<unsigned>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
#endif
  if (const Team* const team = Team::current(); team != nullptr && team->pool() != nullptr)
    available = static_cast<unsigned>(team->threads());
  return static_cast<int>(wanted == 0 ? available : std::min(wanted, available));
}

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

/// What loops run on: never entered where `one_thread_only` holds.
namespace scheduler {

// In the team of this thread, or in one for this call alone.
template <class Work>
auto in_team(const Work& work) {
  if (Team* const team = Team::current()) return work(*team);
  Team team(usable_threads(0));
  return team.lead([&] { return work(team); });
}

template <class First, class Second>
void invoke(const First& first, const Second& second) {
#if !defined(KERF_STANDARD_THREADS) && !defined(KERF_SERIAL)
  if (Team::current() == nullptr) return tbb::parallel_invoke(first, second);
#endif
  in_team([&](Team& team) { team.invoke(first, second); });
}

template <class Index, class Body>
void loop(Index begin, Index end, std::size_t grain, const Body& body) {
#if !defined(KERF_STANDARD_THREADS) && !defined(KERF_SERIAL)
  if (Team::current() == nullptr) {
    tbb::parallel_for(
        tbb::blocked_range<Index>(begin, end, grain),
        [&](const tbb::blocked_range<Index>& range) { body(IndexRange<Index>(range.begin(), range.end())); });
    return;
  }
#endif
  in_team([&](Team& team) {
    team.loop(static_cast<std::size_t>(end - begin), grain, [&](std::size_t from, std::size_t to) {
      body(IndexRange<Index>(static_cast<Index>(begin + from), static_cast<Index>(begin + to)));
    });
  });
}

}  // namespace scheduler

/// Calls `body` with ranges (`begin()`, `end()`) that together make up `begin .. end - 1`, of about `grain`.
template <class Index, class Body>
void parallel_for_ranges(Index begin, Index end, std::size_t grain, const Body& body) {
  if (one_thread_only) {
    const PlainFloatingPoint plain;
    for (Index at = begin; at < end;) {
      const Index next = static_cast<std::size_t>(end - at) > grain ? static_cast<Index>(at + grain) : end;
      body(IndexRange<Index>(at, next));
      at = next;
    }
    return;
  }
  scheduler::loop(begin, end, grain, [&](const IndexRange<Index>& range) {
    const PlainFloatingPoint plain;
    body(range);
  });
}

/// Calls `body(i)` for every i of `0 .. count - 1`.
template <class Index, class Body>
void parallel_for(Index count, const Body& body) {
  const auto each = [&](const IndexRange<Index>& range) {
    const PlainFloatingPoint plain;
    for (Index i = range.begin(); i < range.end(); ++i) body(i);
  };
  if (one_thread_only || count <= 1) return each(IndexRange<Index>(0, count));
  scheduler::loop(Index{0}, count, 1, each);
}

/// Calls both, possibly at the same time.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  const auto plainly = [](const auto& call) {
    return [&call] {
      const PlainFloatingPoint plain;
      call();
    };
  };
  if (one_thread_only) {
    plainly(first)();
    plainly(second)();
    return;
  }
  scheduler::invoke(plainly(first), plainly(second));
}

/// The sum of `body(range)` over ranges of `0 .. count - 1`. These are halves of halves until no more than
/// `grain` is left, and are added up as they were halved: on any number of threads, to the last bit.
template <class Sum, class Index, class Body>
Sum parallel_sum(Index count, std::size_t grain, const Body& body) {
  struct Halves {
    const std::size_t grain;
    const Body& body;
    Sum operator()(Index begin, Index end) const {
      if (static_cast<std::size_t>(end - begin) <= grain) return body(IndexRange<Index>(begin, end));
      const auto middle = static_cast<Index>(begin + (end - begin) / 2);
      Sum left{}, right{};
      parallel_invoke([&] { left = (*this)(begin, middle); }, [&] { right = (*this)(middle, end); });
      return left + right;
    }
  };
  const PlainFloatingPoint plain;
  return Halves{grain, body}(0, count);
}

/// Calls `work` on the threads of the caller's arena, and returns what it returns. While `work` waits for its
/// own tasks this thread takes no others: a task of the caller would run in the middle of the one that
/// called, on the same thread, with the same thread-local data and locks.
template <class Work>
auto isolated(const Work& work) {
  if (one_thread_only || Team::current() != nullptr) return work();
#if defined(KERF_SERIAL) || defined(KERF_STANDARD_THREADS)
  Team team(usable_threads(0));
  return team.lead(work);
#else
  return tbb::this_task_arena::isolate(work);
#endif
}

/// Calls `work` on `wanted` threads and returns what it returns; 0 stands for the threads of the caller's
/// arena. If that has as many as are wanted, `work` runs in it: entering another arena takes 70 microseconds.
/// One thread needs no arena at all.
template <class Work>
auto on_threads(unsigned wanted, const Work& work) {
  if (wanted == 0 || one_thread_only) return isolated(work);
  const int threads = usable_threads(wanted);
  if (threads == 1) return on_this_thread(work);
  if (Team* const team = Team::current(); team != nullptr && team->pool() != nullptr) {
    if (team->threads() == threads) return work();
    Team part(threads, team->pool());
    return part.lead(work);
  }
#if defined(KERF_SERIAL) || defined(KERF_STANDARD_THREADS)
  Team team(threads);
  return team.lead(work);
#else
  if (tbb::this_task_arena::max_concurrency() == threads) return isolated(work);
  tbb::task_arena arena(threads);
  return arena.execute(work);
#endif
}

}  // namespace kerf
