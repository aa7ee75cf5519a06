#include "layout/wide_bvh.hpp"

namespace kerf {

// Compiled once, not for each instruction set: rays seldom ask.
bool same_corners(const WideBvh& bvh, ChildLink leaf, std::uint32_t i, ChildLink other, std::uint32_t j) {
  const std::uint32_t *words = leaf_words(bvh, leaf) + i, *others = leaf_words(bvh, other) + j;
  for (std::size_t row = 0; row < 9; ++row) {
    if (words[row * leaf.count()] != others[row * other.count()]) return false;
  }
  return true;
}

}  // namespace kerf
