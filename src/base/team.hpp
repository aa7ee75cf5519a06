// Threads of the standard library that work on one call together: what loops run on where there is no oneTBB.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "base/fp_environment.hpp"

namespace kerf {

/// The caller's thread and up to `threads - 1` others, which begin when there is first something for them to
/// do and end with the team. A member that waits for a task works on other tasks of the team, and on nothing
/// else.
class Team {
 public:
  explicit Team(int threads) : threads_(threads) {}
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
    for (std::thread& other : others_) other.join();
  }

  /// The team that this thread works in; null outside of any.
  static Team*& current() {
    static thread_local Team* team = nullptr;
    return team;
  }

  /// Calls `work` with this team as the current one, and returns what it returns.
  template <class Work>
  auto lead(const Work& work) {
    struct Restore {
      Team* before = current();
      ~Restore() { current() = before; }
    } restore;
    current() = this;
    return work();
  }

  /// Calls both, possibly at the same time. Throws what the first throws, or else what the second does.
  template <class First, class Second>
  void invoke(const First& first, const Second& second) {
    Task task(second);
    give(task);
    std::exception_ptr error;
    try {
      first();
    } catch (...) {
      error = std::current_exception();
    }
    finish(task);
    if (!error) error = task.error;
    if (error) std::rethrow_exception(error);
  }

  /// Calls `body(begin, end)` with ranges of at most `grain` that together make up `0 .. count - 1`.
  template <class Body>
  void loop(std::size_t count, std::size_t grain, const Body& body) {
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
      for (std::size_t at = next.fetch_add(grain); at < count; at = next.fetch_add(grain)) {
        try {
          body(at, std::min(at + grain, count));
        } catch (...) {
          next = count;  // nobody needs the rest
          throw;
        }
      }
    };
    const std::size_t parts = (count + grain - 1) / grain;
    split(std::min(parts, static_cast<std::size_t>(threads_)), work);
  }

 private:
  struct Task {
    template <class Work>
    explicit Task(const Work& work)
        : context(&work), call([](const void* what) { (*static_cast<const Work*>(what))(); }) {}
    const void* context;
    void (*call)(const void*);
    bool done = false;
    std::exception_ptr error = nullptr;
  };

  // Calls `work` on up to `members` threads.
  template <class Work>
  void split(std::size_t members, const Work& work) {
    if (members <= 1) return work();
    invoke([&] { split(members / 2, work); }, [&] { split(members - members / 2, work); });
  }

  void give(Task& task) {
    {
      const std::lock_guard lock(mutex_);
      recruit();
      waiting_.push_back(&task);
    }
    changed_.notify_all();
  }

  // Takes the task back if nobody has begun it; else works on others until it is done.
  void finish(Task& task) {
    std::unique_lock lock(mutex_);
    const auto at = std::find(waiting_.rbegin(), waiting_.rend(), &task);
    if (at != waiting_.rend()) {
      waiting_.erase(std::next(at).base());
      run(task, lock);
      return;
    }
    while (!task.done) {
      if (waiting_.empty()) {
        changed_.wait(lock, [&] { return task.done || !waiting_.empty(); });
      } else {
        run_newest(lock);
      }
    }
  }

  void run_newest(std::unique_lock<std::mutex>& lock) {
    Task& task = *waiting_.back();
    waiting_.pop_back();
    run(task, lock);
  }
  void run(Task& task, std::unique_lock<std::mutex>& lock) {
    lock.unlock();
    std::exception_ptr error;
    try {
      task.call(task.context);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    task.error = error;
    task.done = true;
    changed_.notify_all();
  }

  // What all members but the first do.
  void serve() {
    const PlainFloatingPoint plain;
    current() = this;
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return closed_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      run_newest(lock);
    }
  }

  // If the system has no more threads, those that there are do the work.
  void recruit() {
    if (!others_.empty() || threads_ <= 1) return;
    others_.reserve(static_cast<std::size_t>(threads_ - 1));
    try {
      for (int i = 1; i < threads_; ++i) others_.emplace_back([this] { serve(); });
    } catch (const std::system_error&) {
      threads_ = static_cast<int>(others_.size()) + 1;
    }
  }

  std::atomic<int> threads_;
  std::vector<std::thread> others_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Task*> waiting_;
  bool closed_ = false;
};

}  // namespace kerf
