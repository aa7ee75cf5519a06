// Memory of the device that frees itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <cuda_runtime_api.h>
#include <kerf/cuda/error.hpp>

namespace kerf::cuda {

/// Throws what went wrong, in a sentence that says during what.
inline void check(cudaError_t result, const char* during) {
  if (result != cudaSuccess) throw Error(during, cudaGetErrorString(result));
}

template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  explicit DeviceArray(std::size_t count) : count_(count) {
    if (count != 0) check(cudaMalloc(&data_, count * sizeof(T)), "taking memory of the device");
  }
  explicit DeviceArray(std::span<const T> values) : DeviceArray(values.size()) {
    if (count_ != 0)
      check(cudaMemcpy(data_, values.data(), values.size_bytes(), cudaMemcpyHostToDevice),
            "copying to the device");
  }
  DeviceArray(DeviceArray&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), count_(std::exchange(other.count_, 0)) {}
  DeviceArray& operator=(DeviceArray&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(count_, other.count_);
    return *this;
  }
  ~DeviceArray() { cudaFree(data_); }

  T* data() const { return static_cast<T*>(data_); }
  std::size_t size() const { return count_; }

  void copy_to(std::span<T> values) const {
    check(cudaMemcpy(values.data(), data_, values.size_bytes(), cudaMemcpyDeviceToHost),
          "copying from the device");
  }

 private:
  void* data_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace kerf::cuda
