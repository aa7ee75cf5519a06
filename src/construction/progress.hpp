// Tells the caller how far a build is, and asks whether it may go on.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>

#include "base/raise.hpp"

namespace kerf {

/// Counts finished work from any thread. Calls back from one thread at a time.
class Progress {
 public:
  /// `total` is the work that makes a fraction of 1. `report` may be empty and must outlive this.
  Progress(const std::function<bool(float)>& report, std::uint64_t total) : report_(report), total_(total) {}

  /// Adds to the finished work. Throws `Error::cancelled` once the callback has returned false. While another
  /// thread is in the callback, this one neither calls nor waits.
  void add(std::uint64_t work) {
    if (!report_) return;
    done_.fetch_add(work, std::memory_order_relaxed);
    if (const std::unique_lock lock(mutex_, std::try_to_lock);
        lock && !cancelled_.load(std::memory_order_relaxed)) {
      const std::uint64_t done = done_.load(std::memory_order_relaxed);
      if (!report_(static_cast<float>(done < total_ ? done : total_) / static_cast<float>(total_))) {
        cancelled_.store(true, std::memory_order_relaxed);
      }
    }
    check();
  }

  /// Throws `Error::cancelled` once the callback has returned false.
  void check() const {
    if (cancelled_.load(std::memory_order_relaxed)) raise(Error::cancelled, "the build was cancelled");
  }

 private:
  const std::function<bool(float)>& report_;
  const std::uint64_t total_;
  std::atomic<std::uint64_t> done_ = 0;
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
};

}  // namespace kerf
