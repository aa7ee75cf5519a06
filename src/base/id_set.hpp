// Which triangles have been found already.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <kerf/ray.hpp>

namespace kerf {

/// A set of triangles' numbers. The heap is needed from the 33rd on.
class IdSet {
 public:
  IdSet() {
    for (std::uint32_t& slot : inline_) slot = invalid_id;
  }
  IdSet(const IdSet&) = delete;
  IdSet& operator=(const IdSet&) = delete;

  std::size_t size() const { return size_; }

  /// False if it is in the set already. Throws `std::bad_alloc`.
  bool insert(std::uint32_t id) {
    std::uint32_t* const slot = find(slots_, shift_, id);
    if (*slot == id) return false;
    *slot = id;
    if (++size_ > std::size_t{1} << (31 - shift_)) grow();
    return true;
  }

 private:
  static constexpr std::uint32_t inline_bits = 6, growth_bits = 2;

  // Where the number stands, or the free slot for it: linear probing after multiplicative hashing (Knuth, The
  // Art of Computer Programming 3, 6.4). The table is at most half full.
  static std::uint32_t* find(std::uint32_t* slots, std::uint32_t shift, std::uint32_t id) {
    const std::uint32_t last = 0xffffffffu >> shift;
    std::uint32_t at = (id * 0x9e3779b1u) >> shift;
    while (slots[at] != invalid_id && slots[at] != id) at = (at + 1) & last;
    return slots + at;
  }

  void grow() {
    const std::uint32_t shift = shift_ - growth_bits;
    std::vector<std::uint32_t> larger(std::size_t{1} << (32 - shift), invalid_id);
    const std::uint32_t* const end = slots_ + (std::size_t{1} << (32 - shift_));
    for (const std::uint32_t* slot = slots_; slot != end; ++slot)
      if (*slot != invalid_id) *find(larger.data(), shift, *slot) = *slot;
    heap_ = std::move(larger);
    slots_ = heap_.data();
    shift_ = shift;
  }

  std::uint32_t inline_[std::size_t{1} << inline_bits];
  std::vector<std::uint32_t> heap_;
  std::uint32_t* slots_ = inline_;
  std::uint32_t shift_ = 32 - inline_bits;
  std::size_t size_ = 0;
};

}  // namespace kerf
