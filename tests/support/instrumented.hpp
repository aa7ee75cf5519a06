// How much of a long loop runs where every instruction is watched or emulated and takes many times as long.
#pragma once

#include <cstddef>

namespace test {

#if defined(__has_feature)  // clang's way to say it
#if __has_feature(thread_sanitizer)
#define KERF_THREADS_WATCHED
#elif __has_feature(address_sanitizer)
#define KERF_MEMORY_WATCHED
#endif
#endif

#if defined(KERF_TEST_SLOWDOWN)  // a build for a machine that is emulated sets it
inline constexpr std::size_t slowdown = KERF_TEST_SLOWDOWN;
#elif defined(__SANITIZE_THREAD__) || defined(KERF_THREADS_WATCHED)
inline constexpr std::size_t slowdown = 16;
#elif defined(__SANITIZE_ADDRESS__) || defined(KERF_MEMORY_WATCHED) || !defined(NDEBUG)
inline constexpr std::size_t slowdown = 4;
#else
inline constexpr std::size_t slowdown = 1;
#endif

/// `count` in a plain release build; a part of it, never 0, under a sanitizer, without optimisation or under
/// emulation. For loops over like cases only: what they look for is found in the release build, and a part of
/// them is enough to show each line of code to the sanitizer.
constexpr std::size_t reduced(std::size_t count) {
  return (count + slowdown - 1) / slowdown;
}

}  // namespace test
