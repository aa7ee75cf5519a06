// Scratch memory for tasks, one piece for each task that runs at the same time.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace kerf {

/// A task borrows a piece and has it to itself until the loan ends. The next task finds its contents as they
/// were left. There are never more pieces than loans at one time.
template <class T>
class ScratchPool {
 public:
  class Loan {
   public:
    Loan(ScratchPool& pool, std::unique_ptr<T> piece) : pool_(pool), piece_(std::move(piece)) {}
    ~Loan() {
      const std::lock_guard lock(pool_.mutex_);
      pool_.free_.push_back(std::move(piece_));  // there is room, see `borrow`
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

    T& operator*() const { return *piece_; }
    T* operator->() const { return piece_.get(); }

   private:
    ScratchPool& pool_;
    std::unique_ptr<T> piece_;
  };

  /// A free piece, or what `make()` returns if there is none.
  template <class Make>
  Loan borrow(const Make& make) {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<T> piece = std::move(free_.back());
        free_.pop_back();
        return Loan(*this, std::move(piece));
      }
    }
    auto piece = std::make_unique<T>(make());
    const std::lock_guard lock(mutex_);
    free_.reserve(pieces_ + 1);
    ++pieces_;
    return Loan(*this, std::move(piece));
  }

  /// The number of pieces.
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return pieces_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<T>> free_;
  std::size_t pieces_ = 0;
};

}  // namespace kerf
