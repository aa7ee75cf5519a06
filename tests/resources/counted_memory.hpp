// Counts the memory of the operators new, and makes allocations fail when a test asks for it.
#pragma once

#include <cstdint>
#include <limits>

namespace counted_memory {

/// Bytes that the operators new of all threads returned and that are not freed yet.
std::int64_t live_bytes();

/// The maximum of `live_bytes` since the last call of `restart_peak`.
std::int64_t peak_bytes();
void restart_peak();

/// Makes the `n`-th allocation from now on (1 is the next), and no other, throw `std::bad_alloc`, as long as
/// this lives.
class FailingAllocation {
 public:
  explicit FailingAllocation(std::int64_t n);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;

  /// Whether that allocation was made, and failed.
  bool happened() const;
};

}  // namespace counted_memory
