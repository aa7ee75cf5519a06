// Memory for large arrays.
#pragma once

#include <cstddef>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace kerf {

/// Memory aligned to a cache line, or as asked for. From the size of a huge page on it is aligned to huge
/// pages, which the system is asked for: a random access then costs no walk of the page table, and new memory
/// comes 512 pages at a time, which takes a tenth as long (docs/decisions/0040). Throws `std::bad_alloc`.
class LargeMemory {
  static constexpr std::size_t cache_line = 64;
  static constexpr std::size_t huge_page = std::size_t{1} << 21;

  // Small pieces for which any alignment is good enough come the plain way, which takes half as long.
  static constexpr std::size_t small = std::size_t{1} << 13;
  static constexpr bool is_plain(std::size_t bytes, std::size_t alignment) {
    return bytes < small && alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__;
  }
  static constexpr std::align_val_t aligned(std::size_t bytes, std::size_t alignment) {
    return std::align_val_t{bytes >= huge_page ? huge_page : alignment < cache_line ? cache_line : alignment};
  }

 public:
  static void* take(std::size_t bytes, std::size_t alignment = cache_line) {
    if (is_plain(bytes, alignment)) return ::operator new(bytes);
    void* const memory = ::operator new(bytes, aligned(bytes, alignment));
#ifdef __linux__
    if (bytes >= huge_page) madvise(memory, bytes, MADV_HUGEPAGE);  // a hint: no harm if refused
#endif
    return memory;
  }

  /// The bytes of so many values. Throws `std::bad_alloc` if no number holds them, which 32-bit programs
  /// meet.
  template <class T>
  static std::size_t bytes_of(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return count * sizeof(T);
  }

  static void give_back(void* memory, std::size_t bytes, std::size_t alignment = cache_line) {
    if (is_plain(bytes, alignment)) return ::operator delete(memory);
    ::operator delete(memory, aligned(bytes, alignment));
  }
};

}  // namespace kerf
