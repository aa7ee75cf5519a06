// A crossing of a ray and a triangle, as kernels find it.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/small_vector.hpp"

namespace kerf {

/// A crossing of a triangle by its number in the `Geometry`.
struct Crossing {
  float t, u, v;
  std::uint32_t id;
};

/// Most rays have no more crossings than need no heap.
using Crossings = SmallVector<Crossing, 1024>;

/// The order in which crossings are reported.
inline bool comes_before(const Crossing& a, const Crossing& b) {
  return a.t != b.t ? a.t < b.t : a.id < b.id;
}

/// Sorts by `comes_before`. Throws `std::bad_alloc`.
///
/// Many are sorted by their digits, bytes of t and of the number, the least first (Knuth, The Art of Computer
/// Programming 3, 5.2.5). A byte in which all agree takes no pass: piles of coplanar triangles differ in
/// their numbers only.
inline void sort_crossings(std::span<Crossing> crossings) {
  constexpr std::size_t many = 1024;
  if (crossings.size() < many) return std::sort(crossings.begin(), crossings.end(), comes_before);
  const auto key = [](const Crossing& crossing) {
    const auto bits = std::bit_cast<std::uint32_t>(crossing.t);
    const std::uint32_t ascending = (bits >> 31) != 0 ? ~bits : bits | 0x80000000u;
    return std::uint64_t{ascending} << 32 | crossing.id;
  };
  std::uint64_t different = 0;
  for (const Crossing& crossing : crossings) different |= key(crossing) ^ key(crossings.front());
  std::vector<Crossing> other(crossings.size());
  std::span<Crossing> from = crossings, to = other;
  for (int shift = 0; shift < 64; shift += 8) {
    if ((different >> shift & 255) == 0) continue;
    std::size_t place[256] = {};
    for (const Crossing& crossing : from) ++place[key(crossing) >> shift & 255];
    std::size_t before = 0;
    for (std::size_t& count : place) before += std::exchange(count, before);
    for (const Crossing& crossing : from) to[place[key(crossing) >> shift & 255]++] = crossing;
    std::swap(from, to);
  }
  if (from.data() != crossings.data()) std::copy(from.begin(), from.end(), crossings.begin());
}

}  // namespace kerf
