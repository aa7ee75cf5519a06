// What leaves have of triangles that stand in several of them, so that the parts can move with the triangles.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "layout/wide_bvh.hpp"

namespace kerf {

/// A corner of a piece: a + u (b - a) + v (c - a) of the triangle (a, b, c), in steps of 1 / 65535.
struct PieceCorner {
  std::uint16_t u, v;
};

/// For each triangle that stands in several leaves, its part in the box of each: a convex polygon, given by
/// its corners. Every point of the triangle lies in one of its pieces, wherever the triangle moves.
class Pieces {
 public:
  Pieces() = default;

  /// The pieces of `wide`, whose boxes hold all points of its triangles, on all threads of the task arena
  /// that this is called in. No two leaves may share memory. Throws `std::bad_alloc`.
  Pieces(const WideBvh& wide, std::size_t triangles);

  /// Which triangles of the leaf stand in others as well: bit i for triangle i.
  std::uint32_t in_leaf(ChildLink leaf) const {
    const std::uint32_t word = leaf.first() / 64, shift = leaf.first() % 64;
    const std::uint64_t above = shift == 0 ? 0 : divided_[word + 1] << (64 - shift);
    return static_cast<std::uint32_t>(divided_[word] >> shift | above) & ((1u << leaf.count()) - 1);
  }

  /// The piece of such a triangle. None for the whole triangle.
  std::span<const PieceCorner> corners(ChildLink leaf, std::uint32_t i) const {
    const std::uint32_t piece = number(leaf.first() + i);
    return {corners_.data() + first_corners_[piece], corners_.data() + first_corners_[piece + 1]};
  }

  std::size_t bytes() const {
    return divided_.size() * sizeof(divided_[0]) + before_.size() * sizeof(before_[0]) +
           first_corners_.size() * sizeof(first_corners_[0]) + corners_.size() * sizeof(corners_[0]);
  }

 private:
  std::uint32_t number(std::uint32_t reference) const {
    const std::uint64_t lower = (std::uint64_t{1} << reference % 64) - 1;
    return before_[reference / 64] +
           static_cast<std::uint32_t>(std::popcount(divided_[reference / 64] & lower));
  }

  std::vector<std::uint64_t> divided_;        // a bit for each triangle of each leaf; one more word
  std::vector<std::uint32_t> before_;         // the bits before each of these words
  std::vector<std::uint32_t> first_corners_;  // of each piece; one more ends the last
  std::vector<PieceCorner> corners_;
};

}  // namespace kerf
