#include "base/team.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <system_error>

#include "base/fp_environment.hpp"

namespace kerf {
namespace {

// `std::condition_variable::wait` would ask for the libstdc++ of GCC 12, which RHEL 9 has not: waits with a
// limit are inline.
template <class Holds>
void wait_until(std::condition_variable& condition, std::unique_lock<std::mutex>& lock, const Holds& holds) {
  while (!condition.wait_for(lock, std::chrono::hours(1), holds)) {
  }
}

}  // namespace

// What a pool is given outlives the team, if the pool comes to it late: then the door is closed.
class Team::Door {
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
    wait_until(left_, lock, [&] { return inside_ == 0; });
    team_ = nullptr;
  }

 private:
  Team* team_;
  int inside_ = 0;
  std::mutex mutex_;
  std::condition_variable left_;
};

struct Team::Task {
  FunctionRef<void()> work;
  bool done = false;
  std::exception_ptr error = nullptr;
};

Team::Team(int threads, const ThreadPool* pool) : threads_(threads), pool_(pool) {
  if (pool != nullptr) door_ = std::make_shared<Door>(this);
}

Team::~Team() {
  if (door_ != nullptr) door_->close();
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  for (std::thread& other : others_) other.join();
}

Team*& Team::current() {
  static thread_local Team* team = nullptr;
  return team;
}

void Team::invoke(FunctionRef<void()> first, FunctionRef<void()> second) {
  Task task{second};
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

void Team::loop(std::size_t count, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> body) {
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

// Calls `work` on up to `members` threads.
void Team::split(std::size_t members, FunctionRef<void()> work) {
  if (members <= 1) return work();
  invoke([&] { split(members / 2, work); }, [&] { split(members - members / 2, work); });
}

void Team::give(Task& task) {
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
void Team::ask_pool() {
  try {
    pool_->start([door = door_] { door->enter(); });
  } catch (...) {
    const std::lock_guard lock(mutex_);
    --helpers_;
  }
}

// What a thread of a pool does when it comes. One that the pool has started in the middle of a member's own
// work is that member's thread, which must not wait here for itself.
void Team::help() {
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
void Team::finish(Task& task) {
  std::unique_lock lock(mutex_);
  const auto at = std::find(waiting_.rbegin(), waiting_.rend(), &task);
  if (at != waiting_.rend()) {
    waiting_.erase(std::next(at).base());
    run(task, lock);
    return;
  }
  while (!task.done) {
    if (waiting_.empty()) {
      wait_until(changed_, lock, [&] { return task.done || !waiting_.empty(); });
    } else {
      run_newest(lock);
    }
  }
}

void Team::run_newest(std::unique_lock<std::mutex>& lock) {
  Task& task = *waiting_.back();
  waiting_.pop_back();
  run(task, lock);
}

void Team::run(Task& task, std::unique_lock<std::mutex>& lock) {
  lock.unlock();
  std::exception_ptr error;
  try {
    task.work();
  } catch (...) {
    error = std::current_exception();
  }
  lock.lock();
  task.error = error;
  task.done = true;
  changed_.notify_all();
}

// What all members but the first do.
void Team::serve() {
  const PlainFloatingPoint plain;
  const Membership member(this);
  std::unique_lock lock(mutex_);
  while (true) {
    wait_until(changed_, lock, [&] { return closed_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    run_newest(lock);
  }
}

// If the system has no more threads, those that there are do the work.
void Team::recruit() {
  if (!others_.empty() || threads_ <= 1) return;
  others_.reserve(static_cast<std::size_t>(threads_ - 1));
  try {
    for (int i = 1; i < threads_; ++i) others_.emplace_back([this] { serve(); });
  } catch (const std::system_error&) {
    threads_ = static_cast<int>(others_.size()) + 1;
  }
}

}  // namespace kerf
