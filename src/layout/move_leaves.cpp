#include "layout/move_leaves.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>

#include <hwy/cache_control.h>

#include "math/coordinate_limit.hpp"
#include "math/triangle.hpp"
#define KERF_FOUR_LANES
#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "layout/move_leaves.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "simd/box-inl.h"
#include "simd/triangle-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// In words of leaves: about what is moved together.
constexpr std::size_t fetched_ahead = 3072, words_per_cache_line = 16;

// Where the corners of a triangle are in the meshes.
struct Addresses {
  const std::byte* corner[3];
};

// As `load_corner`, from an address, which may be that of no float. The third number is in the fourth lane as
// well.
HWY_INLINE Float4 corner_at(const std::byte* at) {
  constexpr hn::FixedTag<float, 2> f32x2;
  float third;
  std::memcpy(&third, at + 2 * sizeof(float), sizeof third);
  const Float4 corner =
      hn::Combine(f32x4, hn::Set(f32x2, third), hn::LoadU(f32x2, reinterpret_cast<const float*>(at)));
  return hn::Add(corner, hn::Zero(f32x4));
}

// A box around a piece of the triangle (a, b, c), wherever that is now; `whole` is around all of it.
//
// A corner is off by half a step in u and in v, which moves it by less than the first summand of the margin,
// the rounding of steps and products included. Each of the two sums rounds by at most 2^-24 of a number that
// is no larger than the triangle's coordinates.
HWY_INLINE SimdBox box_of_piece(Float4 a, Float4 b, Float4 c, const SimdBox& whole,
                                std::span<const PieceCorner> corners) {
  constexpr float step = 1.0f / 65535.0f;
  const Float4 e = hn::Sub(b, a), f = hn::Sub(c, a);
  Float4 lower = hn::Set(f32x4, infinity), upper = hn::Neg(lower);
  for (const PieceCorner& corner : corners) {
    const Float4 u = hn::Set(f32x4, step * static_cast<float>(corner.u)),
                 v = hn::Set(f32x4, step * static_cast<float>(corner.v));
    const Float4 point = hn::Add(hn::Add(a, hn::Mul(u, e)), hn::Mul(v, f));
    lower = hn::Min(lower, point);
    upper = hn::Max(upper, point);
  }
  const Float4 largest = hn::Max(hn::Abs(lower_of(whole)), hn::Abs(negated_upper_of(whole)));
  const Float4 margin = hn::Add(hn::Add(hn::Mul(hn::Set(f32x4, 0x1p-16f), hn::Add(hn::Abs(e), hn::Abs(f))),
                                        hn::Mul(hn::Set(f32x4, 0x1p-22f), largest)),
                                hn::Set(f32x4, std::numeric_limits<float>::min()));
  return intersect(from_halves(hn::Sub(lower, margin), hn::Neg(hn::Add(upper, margin))), whole);
}

HWY_INLINE MovedLeaf move_leaf(const Pieces& pieces, const WideBvh& wide, ChildLink leaf,
                               const Addresses* triangles) {
  const std::uint32_t count = leaf.count(), divided = pieces.in_leaf(leaf);
  auto* const words = const_cast<std::uint32_t*>(leaf_words(wide, leaf));
  SimdBox box = empty_box();
  std::uint32_t flat = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [at_a, at_b, at_c] = triangles[i].corner;
    std::uint32_t* word = words + i;
    for (const std::byte* const at : {at_a, at_b, at_c}) {
      for (std::size_t axis = 0; axis < 3; ++axis, word += count)
        std::memcpy(word, at + axis * sizeof(float), sizeof(float));
    }
    const Float4 a = corner_at(at_a), b = corner_at(at_b), c = corner_at(at_c);
    if (!is_in_range(a, b, c) || (!has_area(a, b, c) && is_degenerate(triangle_in(wide, leaf, i)))) {
      flat |= 1u << i;
      continue;
    }
    SimdBox bounds = bounds_of(a, b, c);
    if ((divided >> i & 1) != 0) {
      const auto piece = pieces.corners(leaf, i);
      if (!piece.empty()) bounds = box_of_piece(a, b, c, bounds, piece);
    }
    box = merge(box, bounds);
  }
  return {to_box3f(box), flat};
}

void move_leaves(const Pieces& pieces, const Geometry& geometry, const WideBvh& wide,
                 std::span<const ChildLink> leaves, MovedLeaf* moved) {
  Addresses triangles[max_leaves_moved * max_leaf_triangles];
  for (const ChildLink leaf : leaves) {
    for (std::uint32_t i = 0; i < leaf.count(); ++i) geometry.prefetch_indices(triangle_id(wide, leaf, i));
    // Leaves lie about in the order of their nodes.
    const std::size_t ahead = words_per_triangle * std::size_t{leaf.first()} + fetched_ahead;
    const std::size_t end = std::min(ahead + words_per_triangle * leaf.count(), wide.leaves.size());
    for (std::size_t i = ahead; i < end; i += words_per_cache_line) hwy::Prefetch(wide.leaves.data() + i);
  }
  Addresses* next = triangles;
  for (const ChildLink leaf : leaves) {
    for (std::uint32_t i = 0; i < leaf.count(); ++i, ++next) {
      const auto [primitive, mesh] = geometry.locate(triangle_id(wide, leaf, i));
      const auto& vertices = geometry.meshes()[mesh].vertices;
      const auto indices = geometry.meshes()[mesh].triangles[primitive];
      for (int k = 0; k < 3; ++k) {
        next->corner[k] = vertices.data() + indices.values[k] * vertices.stride();
        hwy::Prefetch(next->corner[k]);
      }
    }
  }
  next = triangles;
  for (const ChildLink leaf : leaves) {
    *moved++ = move_leaf(pieces, wide, leaf, next);
    next += leaf.count();
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(move_leaves);

void move_leaves(Target target, const Pieces& pieces, const Geometry& geometry, const WideBvh& wide,
                 std::span<const ChildLink> leaves, MovedLeaf* moved) {
  KERF_DISPATCH(move_leaves, target)(pieces, geometry, wide, leaves, moved);
}

}  // namespace kerf
#endif
