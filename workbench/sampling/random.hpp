// Random numbers that are the same on every machine, unlike those of the standard's distributions.
#pragma once

#include <cstdint>

namespace workbench {

/// Scrambles 64 bits so that the outputs of neighbouring inputs seem independent (the finisher of SplitMix64;
/// Steele, Lea & Flood 2014, "Fast Splittable Pseudorandom Number Generators").
constexpr std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

/// SplitMix64. Streams of different seeds are independent. Draw at most one number per full expression,
/// except in braces: compilers evaluate arguments and operands in different orders.
class RandomNumbers {
 public:
  constexpr explicit RandomNumbers(std::uint64_t seed) : state_(scramble(seed + step)) {}

  constexpr std::uint64_t bits() { return scramble(state_ += step); }

  /// In [0, 1), a multiple of 2^-24.
  constexpr float uniform() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }

  /// In [low, high).
  constexpr float between(float low, float high) { return low + (high - low) * uniform(); }

  /// In [0, count).
  constexpr std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>((bits() >> 32) * count >> 32);
  }

 private:
  static constexpr std::uint64_t step = 0x9e3779b97f4a7c15u;
  std::uint64_t state_;
};

}  // namespace workbench
