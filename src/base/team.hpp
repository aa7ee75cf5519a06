// Threads that work on one call together: what loops run on where there is no oneTBB, or where the caller
// gives a pool of its own.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include <kerf/threads.hpp>

#include "base/fp_environment.hpp"

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
  explicit Team(int threads, const ThreadPool* pool = nullptr) : threads_(threads), pool_(pool) {
    if (pool != nullptr) door_ = std::make_shared<Door>(this);
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team() {
    if (door_ != nullptr) door_->close();
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
    for (std::thread& other : others_) other.join();
  }

  int threads() const { return threads_; }
  const ThreadPool* pool() const { return pool_; }  ///< null for threads of the standard library

  /// The team that this thread works in; null outside of any.
  static Team*& current() {
    static thread_local Team* team = nullptr;
    return team;
  }

  /// Calls `work` with this team as the current one, and returns what it returns.
  template <class Work>
  auto lead(const Work& work) {
    const Membership member(this);
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

  // What a pool is given outlives the team, if the pool comes to it late: then the door is closed.
  class Door {
   public:
    explicit Door(Team* team) : team_(team) {}

    void enter() {
      {
        const std::lock_guard lock(mutex_);
        if (team_ == nullptr) return;
        ++inside_;
      }
      team_->help();
      const std::lock_guard lock(mutex_);
      --inside_;
      left_.notify_all();
    }

    void close() {
      std::unique_lock lock(mutex_);
      left_.wait(lock, [&] { return inside_ == 0; });
      team_ = nullptr;
    }

   private:
    Team* team_;
    int inside_ = 0;
    std::mutex mutex_;
    std::condition_variable left_;
  };

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
    bool ask = false;
    {
      const std::lock_guard lock(mutex_);
      if (pool_ == nullptr) {
        recruit();
      } else if (helpers_ + 1 < threads_) {
        ++helpers_;
        ask = true;
      }
      waiting_.push_back(&task);
    }
    changed_.notify_all();
    if (ask) ask_pool();
  }

  // A pool that refuses leaves the work to those that there are.
  void ask_pool() {
    try {
      pool_->start([door = door_] { door->enter(); });
    } catch (...) {
      const std::lock_guard lock(mutex_);
      --helpers_;
    }
  }

  // What a thread of a pool does when it comes. One that the pool has started in the middle of a member's own
  // work is that member's thread, which must not wait here for itself.
  void help() {
    if (current() == this) {
      const std::lock_guard lock(mutex_);
      --helpers_;
      return;
    }
    const PlainFloatingPoint plain;
    const Membership member(this);
    std::unique_lock lock(mutex_);
    while (!waiting_.empty()) run_newest(lock);
    --helpers_;
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
    const Membership member(this);
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
