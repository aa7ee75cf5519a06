// A vector that needs the heap only when it has grown.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace kerf {

/// The first `inline_bytes` of elements lie in the vector itself. Throws `std::bad_alloc`.
template <class T, std::size_t inline_bytes>
class SmallVector {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  SmallVector() : elements_(reinterpret_cast<T*>(inline_)), capacity_(inline_bytes / sizeof(T)) {}
  SmallVector(const SmallVector&) = delete;
  SmallVector& operator=(const SmallVector&) = delete;

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  T* begin() { return elements_; }
  T* end() { return elements_ + size_; }
  T& front() { return elements_[0]; }
  T& back() { return elements_[size_ - 1]; }
  void pop_back() { --size_; }
  /// Keeps the first `size`, which is not larger than the present one.
  void truncate(std::size_t size) { size_ = size; }
  void push_back(const T& element) {
    if (size_ == capacity_) grow();
    elements_[size_++] = element;
  }

 private:
  void grow() {
    std::unique_ptr<T[]> larger(new T[2 * capacity_]);
    std::copy_n(elements_, size_, larger.get());
    heap_ = std::move(larger);
    elements_ = heap_.get();
    capacity_ *= 2;
  }

  alignas(T) std::byte inline_[inline_bytes];
  std::unique_ptr<T[]> heap_;
  T* elements_;
  std::size_t size_ = 0, capacity_;
};

}  // namespace kerf
