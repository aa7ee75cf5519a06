// Runs the build on the device.
#pragma once

#include <algorithm>
#include <cstdint>

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "build/boxes.hpp"
#include "device_array.hpp"

namespace kerf::cuda {

template <class Work>
__global__ void __launch_bounds__(128) run_for_each(std::uint32_t count, Work work) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) work(i);
}

template <class Value>
__global__ void __launch_bounds__(256) add_up(std::uint32_t count, Value value, unsigned long long* total) {
  unsigned long long sum = 0;
  for (std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < count; i += gridDim.x * blockDim.x)
    sum += value(i);
  for (int step = 16; step > 0; step /= 2) sum += __shfl_xor_sync(0xffffffffu, sum, step);
  if ((threadIdx.x & 31) == 0 && sum != 0) atomicAdd(total, sum);
}

// Floats as integers that order alike.
__device__ inline std::uint32_t ordered(float x) {
  const std::uint32_t bits = __float_as_uint(x);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}
__host__ __device__ inline float unordered(std::uint32_t bits) {
  return as_float((bits & 0x80000000u) != 0 ? bits & 0x7fffffffu : ~bits);
}
struct OrderedBounds {
  std::uint32_t lower[3], upper[3], empty;
};
static __global__ void __launch_bounds__(256)
    find_bounds(std::uint32_t count, const Box* boxes, OrderedBounds* out) {
  std::uint32_t lower[3] = {~0u, ~0u, ~0u}, upper[3] = {0, 0, 0}, empty = 0;
  for (std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < count; i += gridDim.x * blockDim.x) {
    const Box box = boxes[i];
    if (is_empty(box)) {
      ++empty;
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = min(lower[axis], ordered(box.lower[axis]));
      upper[axis] = max(upper[axis], ordered(box.upper[axis]));
    }
  }
  empty = __reduce_add_sync(0xffffffffu, empty);
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis] = __reduce_min_sync(0xffffffffu, lower[axis]);
    upper[axis] = __reduce_max_sync(0xffffffffu, upper[axis]);
  }
  if ((threadIdx.x & 31) != 0) return;
  for (int axis = 0; axis < 3; ++axis) {
    atomicMin(&out->lower[axis], lower[axis]);
    atomicMax(&out->upper[axis], upper[axis]);
  }
  atomicAdd(&out->empty, empty);
}

/// Scratch memory comes from one block whose size is known before the build.
class DeviceExecutor {
 public:
  static constexpr std::size_t alignment = 256;

  template <class T>
  using Array = DeviceArray<T>;

  template <class T>
  class Scratch {
   public:
    explicit Scratch(T* data) : data_(data) {}
    T* data() const { return data_; }

   private:
    friend class DeviceExecutor;
    T* data_;
  };

  /// `bytes` for `make`, and room to sort and sum `count` numbers.
  DeviceExecutor(std::size_t bytes, std::uint32_t count, cudaStream_t stream) : stream_(stream) {
    std::size_t for_sums = 0;
    cub::DoubleBuffer<std::uint64_t> keys;
    cub::DoubleBuffer<std::uint32_t> values;
    check(cub::DeviceRadixSort::SortPairs(nullptr, library_bytes_, keys, values, count, 0, 64, stream_),
          "asking what sorting needs");
    check(cub::DeviceScan::ExclusiveSum(nullptr, for_sums, static_cast<std::uint64_t*>(nullptr),
                                        static_cast<std::uint64_t*>(nullptr), count + 1, stream_),
          "asking what summing needs");
    library_bytes_ = (std::max(library_bytes_, for_sums) + alignment - 1) / alignment * alignment;
    const std::size_t for_sort = 12 * std::size_t{count} + 2 * alignment;
    memory_ = DeviceArray<std::byte>(library_bytes_ + alignment + bytes + for_sort);
    used_ = library_bytes_ + alignment;
  }

  std::size_t bytes() const { return memory_.size(); }

  template <class T>
  Scratch<T> make(std::size_t count) {
    T* const data = reinterpret_cast<T*>(memory_.data() + used_);
    used_ += (count * sizeof(T) + alignment - 1) / alignment * alignment;
    if (used_ > memory_.size()) throw Error("building", "scratch memory was counted too small");
    return Scratch<T>(data);
  }
  template <class T>
  DeviceArray<T> keep(std::size_t count) const {
    return DeviceArray<T>(count);
  }
  template <class T>
  void clear(const Scratch<T>& one) const {
    check(cudaMemsetAsync(one.data(), 0, sizeof(T), stream_), "clearing");
  }
  template <class Work>
  void for_each(std::uint32_t count, const Work& work) const {
    if (count == 0) return;
    run_for_each<<<(count + 127) / 128, 128, 0, stream_>>>(count, work);
    check(cudaGetLastError(), "starting a stage of the build");
  }
  template <class Value>
  std::uint64_t sum(std::uint32_t count, const Value& value) const {
    auto* total = reinterpret_cast<unsigned long long*>(memory_.data() + library_bytes_);
    check(cudaMemsetAsync(total, 0, sizeof *total, stream_), "clearing");
    if (count != 0) add_up<<<blocks(count), 256, 0, stream_>>>(count, value, total);
    check(cudaGetLastError(), "starting a sum");
    return read(total);
  }
  Box bounds(const Box* boxes, std::uint32_t count, std::uint32_t& empty) const {
    auto* device = reinterpret_cast<OrderedBounds*>(memory_.data() + library_bytes_);
    const OrderedBounds nothing{{~0u, ~0u, ~0u}, {0, 0, 0}, 0};
    check(cudaMemcpyAsync(device, &nothing, sizeof nothing, cudaMemcpyHostToDevice, stream_), "clearing");
    if (count != 0) find_bounds<<<blocks(count), 256, 0, stream_>>>(count, boxes, device);
    check(cudaGetLastError(), "starting a stage of the build");
    const OrderedBounds found = read(device);
    empty = found.empty;
    Box box = empty_box();
    for (int axis = 0; axis < 3 && found.lower[0] != ~0u; ++axis) {
      box.lower[axis] = unordered(found.lower[axis]);
      box.upper[axis] = unordered(found.upper[axis]);
    }
    return box;
  }
  void exclusive_sum(const std::uint64_t* in, std::uint64_t* out, std::uint32_t count) const {
    std::size_t bytes = library_bytes_;
    check(cub::DeviceScan::ExclusiveSum(memory_.data(), bytes, in, out, count, stream_), "summing");
  }
  void sort(Scratch<std::uint64_t>& keys, Scratch<std::uint32_t>& values, std::uint32_t count) {
    const auto other_keys = make<std::uint64_t>(count);
    const auto other_values = make<std::uint32_t>(count);
    cub::DoubleBuffer<std::uint64_t> key_buffer(keys.data(), other_keys.data());
    cub::DoubleBuffer<std::uint32_t> value_buffer(values.data(), other_values.data());
    std::size_t bytes = library_bytes_;
    check(cub::DeviceRadixSort::SortPairs(memory_.data(), bytes, key_buffer, value_buffer, count, 0, 64,
                                          stream_),
          "sorting");
    keys.data_ = key_buffer.Current();
    values.data_ = value_buffer.Current();
  }
  template <class T>
  T read(const T* at) const {
    T value;
    check(cudaMemcpyAsync(&value, at, sizeof value, cudaMemcpyDeviceToHost, stream_), "reading a result");
    check(cudaStreamSynchronize(stream_), "building");
    return value;
  }

 private:
  static unsigned blocks(std::uint32_t count) { return std::min(1056u, (count + 255) / 256); }

  DeviceArray<std::byte> memory_;  // for sorting and summing, a result, then what `make` gives
  std::size_t library_bytes_ = 0, used_ = 0;
  cudaStream_t stream_;
};

}  // namespace kerf::cuda
