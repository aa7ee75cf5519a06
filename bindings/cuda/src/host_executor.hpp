// Runs the build on the host, with plain code: what tests compare and what the device must agree with.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "build/boxes.hpp"
#include "sort_by_key.hpp"

namespace kerf::cuda {

struct HostExecutor {
  template <class T>
  using Array = std::vector<T>;

  template <class T>
  std::vector<T> make(std::size_t count) const {
    return std::vector<T>(count);
  }
  template <class T>
  std::vector<T> keep(std::size_t count) const {
    return std::vector<T>(count);
  }
  template <class T>
  void clear(std::vector<T>& array) const {
    std::fill(array.begin(), array.end(), T{});
  }
  template <class Work>
  void for_each(std::uint32_t count, const Work& work) const {
    for (std::uint32_t i = 0; i < count; ++i) work(i);
  }
  template <class Value>
  std::uint64_t sum(std::uint32_t count, const Value& value) const {
    std::uint64_t sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) sum += value(i);
    return sum;
  }
  Box bounds(const Box* boxes, std::uint32_t count, std::uint32_t& empty) const {
    Box all = empty_box();
    empty = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (is_empty(boxes[i])) ++empty;
      all = merge(all, boxes[i]);
    }
    return all;
  }
  void exclusive_sum(const std::uint64_t* in, std::uint64_t* out, std::uint32_t count) const {
    std::exclusive_scan(in, in + count, out, std::uint64_t{0});
  }
  void sort(std::vector<std::uint64_t>& keys, std::vector<std::uint32_t>& values, std::uint32_t count) const {
    const std::vector<std::size_t> order = places_by_key(count, [&](std::size_t i) { return keys[i]; });
    const std::vector<std::uint64_t> old_keys = keys;
    const std::vector<std::uint32_t> old_values = values;
    for (std::uint32_t i = 0; i < count; ++i) {
      keys[i] = old_keys[order[i]];
      values[i] = old_values[order[i]];
    }
  }
  template <class T>
  T read(const T* at) const {
    return *at;
  }
};

}  // namespace kerf::cuda
