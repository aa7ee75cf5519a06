// What leaves have of triangles that stand in several of them, so that the parts can move with the triangles.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "layout/wide_bvh.hpp"
#include "math/triangle.hpp"

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

/// A box around a piece of `triangle`, wherever that is now.
///
/// A corner is off by half a step in u and in v, which moves it by less than the first summand of the margin,
/// the rounding of steps and products included. Each of the two sums rounds by at most 2^-24 of a number that
/// is no larger than the triangle's coordinates.
inline Box3f box_of_piece(const Triangle& triangle, std::span<const PieceCorner> corners) {
  const Vec3f e = triangle.v1 - triangle.v0, f = triangle.v2 - triangle.v0;
  const Box3f whole = bounds_of(triangle);
  Box3f box;
  for (const PieceCorner& corner : corners) {
    constexpr float step = 1.0f / 65535.0f;
    const float u = step * static_cast<float>(corner.u), v = step * static_cast<float>(corner.v);
    box = merge(box, triangle.v0 + u * e + v * f);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const float largest = std::max(std::abs(whole.lower[axis]), std::abs(whole.upper[axis]));
    const float margin = 0x1p-16f * (std::abs(e[axis]) + std::abs(f[axis])) + 0x1p-22f * largest +
                         std::numeric_limits<float>::min();
    box.lower[axis] -= margin;
    box.upper[axis] += margin;
  }
  return intersect(box, whole);
}

}  // namespace kerf
