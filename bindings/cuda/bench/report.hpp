// What the bench's parts share: progress lines, clocks, threads.
#pragma once

#include <chrono>
#include <cstdio>
#include <thread>
#include <vector>

#include <cuda_runtime_api.h>

#include "../src/device_array.hpp"

namespace kerf::cuda {

using Clock = std::chrono::steady_clock;
inline const Clock::time_point program_start = Clock::now();

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

template <class... Values>
void say(const char* format, Values... values) {
  std::printf("%7.2f s  ", seconds_since(program_start));
  std::printf(format, values...);
  std::printf("\n");
  std::fflush(stdout);
}

/// Times what runs on the default stream of the device.
class Stopwatch {
 public:
  Stopwatch() {
    check(cudaEventCreate(&begin_), "making an event");
    check(cudaEventCreate(&end_), "making an event");
  }
  Stopwatch(const Stopwatch&) = delete;
  ~Stopwatch() {
    cudaEventDestroy(begin_);
    cudaEventDestroy(end_);
  }
  template <class Launch>
  double milliseconds(Launch&& launch) {
    check(cudaEventRecord(begin_, nullptr), "recording an event");
    launch();
    check(cudaEventRecord(end_, nullptr), "recording an event");
    check(cudaEventSynchronize(end_), "running a kernel");
    float ms = 0;
    check(cudaEventElapsedTime(&ms, begin_, end_), "reading a time");
    return static_cast<double>(ms);
  }

 private:
  cudaEvent_t begin_, end_;
};

/// `work(i)` for each i below `count`, on all processors.
template <class Work>
void on_all_processors(std::size_t count, const Work& work) {
  std::vector<std::thread> threads;
  const std::size_t workers = std::max(1u, std::thread::hardware_concurrency());
  for (std::size_t w = 0; w < workers; ++w)
    threads.emplace_back([&, w] {
      for (std::size_t block = w * 64; block < count; block += workers * 64)
        for (std::size_t i = block; i < std::min(count, block + 64); ++i) work(i);
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace kerf::cuda
