// A program that has a pool of threads already: kerf works on it, and begins no threads of its own.
#include <array>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <kerf/kerf.hpp>
#include <kerf/threads.hpp>

namespace {

// The program's pool: threads that take tasks from a queue.
class Pool {
 public:
  explicit Pool(unsigned threads) {
    for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { serve(); });
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;
  ~Pool() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  unsigned size() const { return static_cast<unsigned>(threads_.size()); }
  void start(std::function<void()> task) {
    {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(std::move(task));
    }
    changed_.notify_one();
  }

 private:
  void serve() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return ends_ || !tasks_.empty(); });
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

// A hilly floor of n by n squares.
struct Floor {
  std::vector<std::array<float, 3>> corners;
  std::vector<std::array<unsigned, 3>> triangles;

  explicit Floor(unsigned n) {
    for (unsigned y = 0; y <= n; ++y) {
      for (unsigned x = 0; x <= n; ++x) {
        const float fx = static_cast<float>(x), fy = static_cast<float>(y);
        corners.push_back({fx, fy, 2 * std::sin(0.1f * fx) * std::cos(0.07f * fy)});
        if (x == n || y == n) continue;
        const unsigned at = y * (n + 1) + x;
        triangles.push_back({at, at + 1, at + n + 2});
        triangles.push_back({at, at + n + 2, at + n + 1});
      }
    }
  }
};

}  // namespace

int main() {
  Pool pool(3);
  const kerf::ThreadPool functions{.threads = [&] { return pool.size() + 1; },  // and the one that calls
                                   .start = [&](std::function<void()> task) { pool.start(std::move(task)); }};
  const Floor floor(300);
  std::vector<kerf::Ray> rays;
  for (int i = 0; i < 100'000; ++i) {
    const float x = static_cast<float>(i % 400) - 49.5f, y = static_cast<float>(i / 400) + 0.5f;
    rays.push_back({.origin = {x, y, 9}, .direction = {0, 0, -1}});
  }

  std::vector<kerf::Hit> hits(rays.size());
  kerf::run_on(functions, [&] {
    const kerf::Bvh bvh = kerf::build({.vertices = floor.corners, .triangles = floor.triangles});
    bvh.intersect(rays, hits);
  });

  std::size_t count = 0;
  for (const kerf::Hit& hit : hits) count += hit ? 1 : 0;
  std::printf("%zu of %zu rays hit the floor\n", count, rays.size());
}
