// Memory for large arrays that traversal walks at random.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include "base/large_memory.hpp"

namespace kerf {

/// A fixed number of trivial values in `LargeMemory`, not initialised. docs/decisions/0040 has the gain for
/// diffuse rays on a mesh of 871,414 triangles.
template <class T>
class AlignedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  AlignedArray() = default;

  /// Throws `std::bad_alloc`.
  explicit AlignedArray(std::size_t size) : size_(size) {
    data_.reset(static_cast<T*>(LargeMemory::take(LargeMemory::bytes_of<T>(size))), Free{size * sizeof(T)});
  }

  std::size_t size() const { return size_; }
  T* data() const { return data_.get(); }
  T& operator[](std::size_t i) const { return data_.get()[i]; }

  /// Keeps the memory, for views that outlive this array.
  std::shared_ptr<const void> owner() const { return data_; }

 private:
  struct Free {
    std::size_t bytes;
    void operator()(T* p) const { LargeMemory::give_back(p, bytes); }
  };
  std::shared_ptr<T> data_;
  std::size_t size_ = 0;
};

}  // namespace kerf
