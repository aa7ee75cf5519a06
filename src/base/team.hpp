// Threads that work on one call together: what loops run on where there is no oneTBB, or where the caller
// gives a pool of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <kerf/threads.hpp>

#include "base/function_ref.hpp"

namespace kerf {

/// True while the work of this thread is to run on this thread only.
#if defined(KERF_SERIAL)
inline thread_local bool one_thread_only = true;
#else
inline thread_local bool one_thread_only = false;
#endif

/// The caller's thread and up to `threads - 1` others. Those of the standard library begin when there is
/// first something for them to do and end with the team. Those of a caller's pool are asked for whenever
/// there is something to do, leave when there is nothing, and may come late or never. A member that waits for
/// a task works on other tasks of the team, and on nothing else.
class Team {
 public:
  explicit Team(int threads, const ThreadPool* pool = nullptr);
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team();

  int threads() const { return threads_; }
  const ThreadPool* pool() const { return pool_; }  ///< null for threads of the standard library

  /// The team that this thread works in; null outside of any.
  static Team*& current();

  /// Calls `work` with this team as the current one, and returns what it returns.
  template <class Work>
  auto lead(const Work& work) {
    const Membership member(this);
    return work();
  }

  /// Calls both, possibly at the same time. Throws what the first throws, or else what the second does.
  void invoke(FunctionRef<void()> first, FunctionRef<void()> second);

  /// Calls `body(begin, end)` with ranges of at most `grain` that together make up `0 .. count - 1`.
  void loop(std::size_t count, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> body);

 private:
  // While it lives, this thread is one of the team.
  struct Membership {
    explicit Membership(Team* team) {
      current() = team;
      one_thread_only = false;
    }
    Membership(const Membership&) = delete;
    Membership& operator=(const Membership&) = delete;
    ~Membership() {
      current() = team_before;
      one_thread_only = alone_before;
    }
    Team* team_before = current();
    bool alone_before = one_thread_only;
  };

  class Door;
  struct Task;

  void split(std::size_t members, FunctionRef<void()> work);
  void give(Task& task);
  void ask_pool();
  void help();
  void finish(Task& task);
  void run_newest(std::unique_lock<std::mutex>& lock);
  void run(Task& task, std::unique_lock<std::mutex>& lock);
  void serve();
  void recruit();

  std::atomic<int> threads_;
  const ThreadPool* pool_;
  std::shared_ptr<Door> door_;
  int helpers_ = 0;  // that the pool was asked for and that have not left
  std::vector<std::thread> others_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Task*> waiting_;
  bool closed_ = false;
};

}  // namespace kerf
