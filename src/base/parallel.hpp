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

#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/fp_environment.hpp"
#include "base/function_ref.hpp"
#include "base/team.hpp"

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
int usable_threads(unsigned wanted);

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

/// What loops run on, compiled once for all of them. Never entered where `one_thread_only` holds.
namespace scheduler {

void invoke(FunctionRef<void()> first, FunctionRef<void()> second);
void loop(std::size_t begin, std::size_t end, std::size_t grain,
          FunctionRef<void(std::size_t, std::size_t)> body);
void isolated(FunctionRef<void()> work);
void on_threads(unsigned wanted, FunctionRef<void()> work);

// What `work` returns, where `run` calls it.
template <class Run, class Work>
auto returned(const Run& run, const Work& work) {
  using Result = std::invoke_result_t<const Work&>;
  if constexpr (std::is_void_v<Result>) {
    run(work);
  } else {
    std::optional<Result> result;
    run([&] { result.emplace(work()); });
    return std::move(*result);
  }
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
  scheduler::loop(begin, end, grain, [&](std::size_t from, std::size_t to) {
    const PlainFloatingPoint plain;
    body(IndexRange<Index>(static_cast<Index>(from), static_cast<Index>(to)));
  });
}

/// Calls `body(i)` for every i of `0 .. count - 1`.
template <class Index, class Body>
void parallel_for(Index count, const Body& body) {
  const auto each = [&](std::size_t begin, std::size_t end) {
    const PlainFloatingPoint plain;
    for (std::size_t i = begin; i < end; ++i) body(static_cast<Index>(i));
  };
  if (one_thread_only || count <= 1) return each(0, count);
  scheduler::loop(0, count, 1, each);
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
  return scheduler::returned([](FunctionRef<void()> call) { scheduler::isolated(call); }, work);
}

/// Calls `work` on `wanted` threads and returns what it returns; 0 stands for the threads of the caller's
/// arena. If that has as many as are wanted, `work` runs in it: entering another arena takes 70 microseconds.
/// One thread needs no arena at all.
template <class Work>
auto on_threads(unsigned wanted, const Work& work) {
  return scheduler::returned([&](FunctionRef<void()> call) { scheduler::on_threads(wanted, call); }, work);
}

}  // namespace kerf
