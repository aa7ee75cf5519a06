// Calls on threads of the caller's: the same answers as on those that the library was built for.
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/threads.hpp>

#include "support/adversarial.hpp"
#include "support/random_triangles.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

// Threads and a queue, as many programs have them.
class Pool {
 public:
  explicit Pool(int threads) {
    for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { serve(); });
  }
  ~Pool() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  void start(std::function<void()> task) {
    {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(std::move(task));
    }
    changed_.notify_one();
  }
  std::set<std::thread::id> ids() const {
    std::set<std::thread::id> ids;
    for (const std::thread& thread : threads_) ids.insert(thread.get_id());
    return ids;
  }
  ThreadPool functions(unsigned threads) {
    return {.threads = [threads] { return threads; },
            .start = [this](std::function<void()> task) { start(std::move(task)); }};
  }

 private:
  void serve() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return ends_ || !tasks_.empty(); });
      if (tasks_.empty()) return;
      const std::function<void()> task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  bool ends_ = false;
  std::vector<std::thread> threads_;
};

// Everything that has loops: builds, calls for many, and refits.
struct Work {
  workbench::Solid solid = workbench::make_sphere(5);
  std::vector<Ray> rays;

  Work() {
    std::mt19937 random(4);
    for (int i = 0; i < 5000; ++i)
      rays.push_back({.origin = adversarial::uniform_point(random, 2.0f),
                      .direction = adversarial::uniform_point(random, 1.0f)});
  }

  struct Answers {
    std::vector<Hit> hits;
    std::vector<Hit> all;
    std::size_t nodes = 0;
    double cost_ratio = 0;
    bool operator==(const Answers&) const = default;
  };
  Answers operator()(unsigned threads = 0) const {
    Answers answers;
    Bvh bvh = build(solid.mesh(), {.threads = threads});
    answers.nodes = bvh.statistics().nodes;
    answers.hits.resize(rays.size());
    bvh.intersect(rays, answers.hits, {.threads = threads});
    answers.all = bvh.all_hits(rays, {.threads = threads}).items;
    answers.cost_ratio = refit(bvh, solid.mesh(), {.threads = threads}).cost_ratio;
    return answers;
  }
};

Work::Answers on(const ThreadPool& pool, const Work& work, unsigned threads = 0) {
  Work::Answers answers;
  run_on(pool, [&] { answers = work(threads); });
  return answers;
}

TEST(Threads, APoolAnswersAsTheLibrarysThreadsDo) {
  const Work work;
  const Work::Answers expected = work();
  for (const unsigned threads : {1u, 2u, 4u}) {
    Pool pool(static_cast<int>(threads) - 1);
    EXPECT_EQ(on(pool.functions(threads), work), expected);
    EXPECT_EQ(on(pool.functions(threads), work, 2), expected);
  }
}

TEST(Threads, WorkIsDoneByTheCallerAndThePoolAlone) {
  Pool pool(2);
  std::set<std::thread::id> allowed = pool.ids(), seen;
  allowed.insert(std::this_thread::get_id());
  const Work work;
  const Bvh bvh = build(work.solid.mesh());
  std::mutex mutex;
  std::vector<Hit> hits(work.rays.size());
  const auto trace = [&](unsigned threads) {
    seen.clear();
    bvh.intersect(work.rays, hits,
                  [&](std::size_t, const Hit&) {
                    const std::lock_guard lock(mutex);
                    seen.insert(std::this_thread::get_id());
                    return true;
                  },
                  {.threads = threads});
  };
  for (int round = 0; round < 1000 && seen.size() < 2; ++round) run_on(pool.functions(3), [&] { trace(0); });
  EXPECT_TRUE(std::includes(allowed.begin(), allowed.end(), seen.begin(), seen.end()));
  EXPECT_GT(seen.size(), 1u) << "the pool has helped";
  run_on(pool.functions(3), [&] { trace(1); });
  EXPECT_EQ(seen, std::set{std::this_thread::get_id()});
}

TEST(Threads, NoCallWaitsForATaskThatHasNotBegun) {
  const Work work;
  const Work::Answers expected = work();
  std::vector<std::function<void()>> tasks;
  const ThreadPool late{.threads = [] { return 4u; },
                        .start = [&](std::function<void()> task) { tasks.push_back(std::move(task)); }};
  EXPECT_EQ(on(late, work), expected);
  EXPECT_FALSE(tasks.empty());
  for (const auto& task : tasks) task();  // after the calls have ended
  const ThreadPool at_once{.threads = [] { return 4u; }, .start = [](const auto& task) { task(); }};
  EXPECT_EQ(on(at_once, work), expected);
  const ThreadPool refusing{.threads = [] { return 4u; },
                            .start = [](const auto&) { throw std::runtime_error("full"); }};
  EXPECT_EQ(on(refusing, work), expected);
}

TEST(Threads, APoolsOwnThreadsMayCall) {
  const Work work;
  const Work::Answers expected = work();
  constexpr int callers = 6;
  std::atomic<int> right = 0, ended = 0;
  {
    Pool pool(2);  // fewer threads than callers: all are busy with them
    for (int i = 0; i < callers; ++i) {
      pool.start([&] {
        if (on(pool.functions(3), work) == expected) ++right;
        ++ended;
      });
    }
  }
  EXPECT_EQ(ended, callers);
  EXPECT_EQ(right, callers);
}

TEST(Threads, WhatWorkThrowsComesOutAndAPoolNeedsItsFunctions) {
  Pool pool(2);
  EXPECT_THROW(run_on(pool.functions(3), [] { throw std::runtime_error("failed"); }), std::runtime_error);
  const Work work;
  const Bvh bvh = build(work.solid.mesh());
  std::vector<Hit> hits(work.rays.size());
  EXPECT_THROW(run_on(pool.functions(3),
                      [&] {
                        bvh.intersect(work.rays, hits, [](std::size_t i, const Hit&) -> bool {
                          if (i > 2000) throw std::runtime_error("a filter has failed");
                          return true;
                        });
                      }),
               std::runtime_error);
  EXPECT_THROW(run_on({}, [] {}), Error);
  EXPECT_THROW(run_on({.threads = [] { return 2u; }, .start = {}}, [] {}), Error);
  EXPECT_THROW(run_on(pool.functions(3), {}), Error);
  const ThreadPool none{.threads = [] { return 0u; }, .start = [](const auto&) {}};
  EXPECT_EQ(on(none, work), work());
}

}  // namespace
}  // namespace kerf
