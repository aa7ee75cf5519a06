// Memory for large arrays that traversal walks at random.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace kerf {

/// A fixed number of trivial values, not initialised, aligned to a cache line; from one huge page on to huge
/// pages, which the system is asked for, so that a random visit costs no walk through the page table.
/// (Diffuse rays on a mesh of 871,414 triangles: see docs/decisions.md.)
template <class T>
class AlignedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  static constexpr std::size_t cache_line = 64;
  static constexpr std::size_t huge_page = std::size_t{1} << 21;

 public:
  AlignedArray() = default;

  /// Throws `std::bad_alloc`.
  explicit AlignedArray(std::size_t size) : size_(size) {
    const std::size_t bytes = size * sizeof(T);
    const std::size_t alignment = bytes >= huge_page ? huge_page : cache_line;
    data_.reset(static_cast<T*>(::operator new (bytes, std::align_val_t{alignment})), Free{alignment});
#ifdef __linux__
    if (alignment == huge_page) madvise(data_.get(), bytes, MADV_HUGEPAGE);  // a wish: no harm if refused
#endif
  }

  std::size_t size() const {
    return size_;
  }
  T* data() const {
    return data_.get();
  }
  T& operator[](std::size_t i) const {
    return data_.get()[i];
  }

  /// What keeps the memory: for views that outlive this array.
  std::shared_ptr<const void> owner() const {
    return data_;
  }

 private:
  struct Free {
    std::size_t alignment;
    void operator()(T* p) const { ::operator delete (p, std::align_val_t{alignment}); }
  };
  std::shared_ptr<T> data_;
  std::size_t size_ = 0;
};

}  // namespace kerf
