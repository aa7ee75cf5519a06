// Memory for large arrays.
#pragma once

#include <cstddef>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace kerf {

/// Memory aligned to a cache line. From the size of a huge page on it is aligned to huge pages, which the
/// system is asked for: a random access then costs no walk of the page table, and new memory comes 512 pages
/// at a time, which takes a tenth as long (docs/decisions/0040). Throws `std::bad_alloc`.
class LargeMemory {
  static constexpr std::size_t cache_line = 64;
  static constexpr std::size_t huge_page = std::size_t{1} << 21;

  static constexpr std::align_val_t alignment(std::size_t bytes) {
    return std::align_val_t{bytes >= huge_page ? huge_page : cache_line};
  }

 public:
  static void* take(std::size_t bytes) {
    void* const memory = ::operator new(bytes, alignment(bytes));
#ifdef __linux__
    if (bytes >= huge_page) madvise(memory, bytes, MADV_HUGEPAGE);  // a hint: no harm if refused
#endif
    return memory;
  }

  static void give_back(void* memory, std::size_t bytes) {
    ::operator delete(memory, alignment(bytes));
  }
};

}  // namespace kerf
