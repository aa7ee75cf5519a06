// What the bench's parts share: progress lines, clocks, threads.
#pragma once

#include <chrono>
#include <cstdio>
#include <thread>
#include <vector>

#include "../src/stopwatch.hpp"

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
