#include "resources/counted_memory.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::int64_t> live{0}, peak{0};
constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
std::atomic<std::int64_t> until_failure{never};

void fail_if_due() {
  if (until_failure.load(std::memory_order_relaxed) != never && until_failure.fetch_sub(1) == 1)
    throw std::bad_alloc();
}

// Lies before each allocation. The bytes asked for are what is counted: the room that an alignment to huge
// pages leaves is never touched.
struct Header {
  std::size_t bytes;   // asked for
  std::size_t before;  // bytes from the start of the memory to the allocation
};

void* allocate(std::size_t bytes, std::size_t alignment) {
  const std::size_t before = std::max(alignment, sizeof(Header));
  void* memory = nullptr;
  if (::posix_memalign(&memory, before, before + bytes) != 0) throw std::bad_alloc();
  auto* const piece = static_cast<std::byte*>(memory) + before;
  new (piece - sizeof(Header)) Header{bytes, before};
  const auto size = static_cast<std::int64_t>(bytes);
  const std::int64_t now = live.fetch_add(size) + size;
  std::int64_t max = peak.load();
  while (max < now && !peak.compare_exchange_weak(max, now)) {
  }
  return piece;
}

void release(void* memory) {
  if (memory == nullptr) return;
  auto* const piece = static_cast<std::byte*>(memory);
  const Header header = *reinterpret_cast<const Header*>(piece - sizeof(Header));
  live.fetch_sub(static_cast<std::int64_t>(header.bytes));
  std::free(piece - header.before);
}

}  // namespace

void* operator new(std::size_t bytes) {
  fail_if_due();
  return allocate(bytes, alignof(std::max_align_t));
}
void* operator new[](std::size_t bytes) {
  fail_if_due();
  return allocate(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  fail_if_due();
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  fail_if_due();
  return allocate(bytes, static_cast<std::size_t>(alignment));
}

// Callers of these, such as std::stable_sort for its buffer, continue without the memory and report nothing.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return allocate(bytes, alignof(std::max_align_t));
}

void operator delete(void* memory) noexcept {
  release(memory);
}
void operator delete[](void* memory) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  release(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  release(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  release(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  release(memory);
}

namespace counted_memory {

std::int64_t live_bytes() {
  return live.load();
}
std::int64_t peak_bytes() {
  return peak.load();
}
void restart_peak() {
  peak.store(live.load());
}

FailingAllocation::FailingAllocation(std::int64_t n) {
  until_failure.store(n);
}
FailingAllocation::~FailingAllocation() {
  until_failure.store(never);
}
bool FailingAllocation::happened() const {
  return until_failure.load() <= 0;
}

}  // namespace counted_memory
