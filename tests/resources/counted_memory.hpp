// Memory from the operators new, counted, and made to fail when a test says so.
#pragma once

#include <cstdint>
#include <limits>

namespace counted_memory {

/// Bytes taken by the operators new and not given back. All threads together.
std::int64_t live_bytes();

/// The most that `live_bytes` has been since the last call of `restart_peak`.
std::int64_t peak_bytes();
void restart_peak();

/// Lets the `n`-th allocation from now on (1 is the next), and it alone, throw `std::bad_alloc`, as long as
/// this lives.
class FailingAllocation {
 public:
  explicit FailingAllocation(std::int64_t n);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;

  /// Whether the allocation came, and failed.
  bool happened() const;
};

}  // namespace counted_memory
