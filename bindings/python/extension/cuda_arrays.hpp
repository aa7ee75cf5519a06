// Arrays in the memory of a device: those of other libraries, read and written where they lie, and kerf's
// own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <cuda_runtime_api.h>
#include <kerf/cuda/arrays.hpp>
#include <kerf/cuda/bvh.hpp>
#include <nanobind/nanobind.h>

namespace kerf::python {

namespace nb = nanobind;
using cuda::Stream;

inline void check(cudaError_t result, const std::string& during) {
  if (result == cudaSuccess) return;
  cudaGetLastError();  // what has been told is not found by the next call
  throw cuda::Error(during, cudaGetErrorString(result));
}

/// Makes a device the current one of this thread while a call runs.
class OnDevice {
 public:
  explicit OnDevice(int device);
  ~OnDevice();
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;

 private:
  int before_ = -1;  // the one to return to; none if it is the same
};

/// The device that is current, or 0 where there is none.
int current_device();

/// Allows this thread to take and give back memory while another one captures a graph.
class DuringCaptures {
 public:
  DuringCaptures() { cudaThreadExchangeStreamCaptureMode(&mode_); }
  ~DuringCaptures() { cudaThreadExchangeStreamCaptureMode(&mode_); }
  DuringCaptures(const DuringCaptures&) = delete;
  DuringCaptures& operator=(const DuringCaptures&) = delete;

 private:
  cudaStreamCaptureMode mode_ = cudaStreamCaptureModeRelaxed;
};

/// Memory that answers are written to. Who reads them later waits for the event that follows the writing, so
/// that the stream need not live on. Giving the memory back waits for all work of the device.
class DeviceMemory {
 public:
  DeviceMemory(int device, std::size_t bytes);
  ~DeviceMemory();
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  std::byte* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }
  int device() const { return device_; }

  /// What `stream` does from here on comes after the writing, and so does what waits for `written`. Nothing
  /// is noted while the stream is captured into a graph, which orders its own calls.
  void mark_written(Stream stream);
  void make_wait(Stream stream) const;  ///< `stream`, for the writing
  void wait() const;                    ///< the caller, for the writing
  bool is_written() const;              ///< whether nobody needs to wait any more

 private:
  int device_;
  std::size_t bytes_;
  std::byte* data_ = nullptr;
  cudaEvent_t written_ = nullptr;
  bool is_marked_ = false;
};

/// Memory for one call, taken and given back in the order of its stream.
class ScratchMemory {
 public:
  ScratchMemory() = default;
  ScratchMemory(std::size_t bytes, Stream stream) : stream_(stream) {
    if (bytes != 0) check(cudaMallocAsync(&data_, bytes, stream), "taking memory of the device");
  }
  ScratchMemory(ScratchMemory&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), stream_(other.stream_) {}
  ScratchMemory& operator=(ScratchMemory&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(stream_, other.stream_);
    return *this;
  }
  ~ScratchMemory() {
    if (data_ != nullptr) cudaFreeAsync(data_, stream_);
  }

  void* data() const { return data_; }

 private:
  void* data_ = nullptr;
  Stream stream_ = nullptr;
};

/// Calls `read`; what it says against an array becomes a `ValueError` that begins with the array's name.
template <class Read>
auto named(const Read& read) {
  try {
    return read();
  } catch (const cuda::Error& error) {
    constexpr std::string_view before = "CUDA: while reading the array ";
    const std::string_view text = error.what();
    if (text.substr(0, before.size()) != before) throw;
    throw nb::value_error(error.what() + before.size());
  }
}

/// An array of any library, taken for one call: its library sees to it that what `stream` does from here on
/// comes after what it did to the array before. Errors are a `ValueError` or a `TypeError` that begins with
/// the array's name.
class TakenArray {
  struct Interface;

  template <class Get>
  auto read(int device, const Get& get) const {
    const auto view = named([&] { return get(described(device)); });
    check_place(device, view.data());
    return view;
  }

 public:
  TakenArray(nb::handle object, std::string name, Stream stream);

  /// The one that the array lies on.
  int device() const;

  template <class T>
  std::span<T> elements(int device) const {
    return read(device, [&](const cuda::ForeignArray& array) { return array.elements<T>(device); });
  }
  TripleView<float> vertices(int device) const {
    return read(device, [&](const cuda::ForeignArray& array) { return array.vertices(device); });
  }
  TripleView<std::uint32_t> triangles(int device) const {
    return read(device, [&](const cuda::ForeignArray& array) { return array.triangles(device); });
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw nb::value_error((name_ + ": " + reason).c_str());
  }

 private:
  void take_tensor(nb::handle object, Stream stream);
  void take_interface(nb::handle object, Stream stream);
  cuda::ForeignArray described(int device) const;
  void check_place(int device, const void* data) const;

  std::string name_;
  std::variant<std::monostate, cuda::OwnedTensor<cuda::dlpack::Managed>,
               cuda::OwnedTensor<cuda::dlpack::Versioned>>
      tensor_;
  std::shared_ptr<const Interface> interface_;
};

/// A capsule of DLPack that shares `memory`. Shape and strides are counted in elements.
nb::capsule to_capsule(std::shared_ptr<DeviceMemory> memory, std::size_t offset,
                       std::span<const std::int64_t> shape, std::span<const std::int64_t> strides,
                       cuda::dlpack::DataType type, bool versioned);

}  // namespace kerf::python
