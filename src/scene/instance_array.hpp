// The instances of a scene, copied by all threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include <kerf/scene.hpp>

#include "base/large_memory.hpp"

namespace kerf {

/// As a vector of instances that never changes once it is filled. Each block of them is copied by whoever is
/// the first to read it.
class InstanceArray {
 public:
  static constexpr std::size_t block = 1024;

  InstanceArray() = default;
  InstanceArray(const InstanceArray&) = delete;
  InstanceArray& operator=(const InstanceArray&) = delete;
  ~InstanceArray() {
    for (std::size_t i = 0; i < blocks(); ++i)
      if (copied_[i]) std::destroy(data_ + begin_of(i), data_ + end_of(i));
    if (data_ != nullptr) LargeMemory::give_back(data_, size_ * sizeof(Instance));
  }

  /// Makes room for `size` instances; once, and before all copies. Throws `std::bad_alloc`.
  void reserve(std::size_t size) {
    if (size == 0) return;
    copied_ = std::make_unique<bool[]>((size + block - 1) / block);
    data_ = static_cast<Instance*>(LargeMemory::take(LargeMemory::bytes_of<Instance>(size)));
    size_ = size;
  }

  std::size_t blocks() const { return (size_ + block - 1) / block; }
  std::size_t begin_of(std::size_t i) const { return i * block; }
  std::size_t end_of(std::size_t i) const { return std::min((i + 1) * block, size_); }

  /// Copies block `i` of `instances`, which are as many as there is room for.
  void copy(std::span<const Instance> instances, std::size_t i) {
    std::uninitialized_copy(instances.begin() + static_cast<std::ptrdiff_t>(begin_of(i)),
                            instances.begin() + static_cast<std::ptrdiff_t>(end_of(i)), data_ + begin_of(i));
    copied_[i] = true;
  }

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const Instance* data() const { return data_; }
  const Instance* begin() const { return data_; }
  const Instance* end() const { return data_ + size_; }
  const Instance& operator[](std::size_t i) const { return data_[i]; }

 private:
  std::unique_ptr<bool[]> copied_;  // of each block
  Instance* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace kerf
