// Where references stand while a tree is built.
#pragma once

#include <algorithm>
#include <cstdint>

#include "tree/reference.hpp"

namespace kerf {

/// The references of a node stand in the arena from `begin` to `end`. From there to `limit` is room for those
/// that spatial splits below the node make.
///
///     |<------ count ------>|<- slack ->|
///     begin               end         limit
struct Range {
  std::uint32_t begin = 0, end = 0, limit = 0;

  std::uint32_t count() const { return end - begin; }
  std::uint32_t slack() const { return limit - end; }
  std::uint32_t capacity() const { return limit - begin; }
};

struct RangePair {
  Range left, right;
};

/// Children share their parent's slack in proportion to their references (Fuetterling et al. 2016). On entry
/// the references of the right child follow those of the left directly; they move up to make room. Their
/// order means nothing, so that only as many move as there is room to make.
inline RangePair hand_down(Reference* arena, const Range& parent, std::uint32_t left_count,
                           std::uint32_t right_count) {
  const auto slack = static_cast<std::uint64_t>(parent.capacity() - left_count - right_count);
  const auto left_slack = static_cast<std::uint32_t>(slack * left_count / (left_count + right_count));
  const std::uint32_t left_end = parent.begin + left_count, right_begin = left_end + left_slack;
  const std::uint32_t moved = std::min(left_slack, right_count);
  std::copy_n(arena + left_end, moved, arena + right_begin + right_count - moved);
  return {{parent.begin, left_end, right_begin}, {right_begin, right_begin + right_count, parent.limit}};
}

}  // namespace kerf
