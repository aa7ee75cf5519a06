// A point and the boxes of a node.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_POINTS_POINT_BOXES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_POINTS_POINT_BOXES_INL_H
#undef KERF_TRAVERSAL_POINTS_POINT_BOXES_INL_H
#else
#define KERF_TRAVERSAL_POINTS_POINT_BOXES_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>

#include <hwy/highway.h>

#include "layout/wide_bvh.hpp"
#include "math/point_box.hpp"
#include "simd/floats-inl.h"
#include "traversal/node-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// One key per slot: a lower bound of the squared distances to the points of its box. It is the bits of a
// float, which sort as the float does, with the slot in the lowest four bits.
struct Keys {
  using Tag = hn::RebindToUnsigned<NodeFloats::Tag>;
  static constexpr std::uint32_t slot_bits = 15;
  static constexpr std::uint32_t none = 0xffffffffu;
  hn::Vec<Tag> vector[NodeFloats::vectors];
};

HWY_INLINE Keys make_keys(const NodeFloats& squared_distances) {
  const Keys::Tag tag;
  Keys keys;
  for (std::size_t i = 0; i < NodeFloats::vectors; ++i) {
    const auto bits = hn::BitCast(tag, squared_distances.vector[i]);
    const auto slots = hn::Iota(tag, static_cast<std::uint32_t>(i * NodeFloats::lanes));
    keys.vector[i] = hn::Or(hn::And(bits, hn::Set(tag, ~Keys::slot_bits)), slots);
  }
  return keys;
}
HWY_INLINE std::uint32_t min_key(const Keys& keys) {
  auto lowest = keys.vector[0];
  for (std::size_t i = 1; i < NodeFloats::vectors; ++i) lowest = hn::Min(lowest, keys.vector[i]);
  return hn::GetLane(hn::MinOfLanes(Keys::Tag(), lowest));
}
HWY_INLINE Keys without(Keys keys, std::uint32_t key) {
  const Keys::Tag tag;
  for (auto& vector : keys.vector)
    vector = hn::IfThenElse(hn::Eq(vector, hn::Set(tag, key)), hn::Set(tag, Keys::none), vector);
  return keys;
}
// Bit i: the key of slot i is not above `limit`.
HWY_INLINE std::uint32_t not_above(const Keys& keys, std::uint32_t limit) {
  const Keys::Tag tag;
  std::uint32_t above = 0;
  for (std::size_t i = 0; i < NodeFloats::vectors; ++i)
    above |= bits(tag, hn::Gt(keys.vector[i], hn::Set(tag, limit))) << (i * NodeFloats::lanes);
  return ~above & ((1u << node_width) - 1);
}

// Distances in single precision. The scene is scaled by a power of two to coordinates below 1, so that no
// square leaves the range of a float.
class PointBoxes {
 public:
  // The largest distance of `p`, in extents of the scene. From farther away the distances of boxes differ by
  // too little for a float.
  static constexpr double max_extents = 256.0;

  HWY_INLINE PointBoxes(const Vec3f& p, const WideBvh& bvh) {
    const float largest = std::max({bvh.largest_coordinate, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    scale_ = std::ldexp(1.0f, std::clamp(-std::ilogb(std::max(largest, 0x1p-100f)) - 1, -127, 100));
    const NodeFloats::Tag tag;
    scales_ = hn::Set(tag, scale_);
    for (int axis = 0; axis < 3; ++axis) point_[axis] = hn::Set(tag, p[axis] * scale_);
  }

  HWY_INLINE Keys keys(const Node& node) const {
    const NodeFloats::Tag tag;
    NodeFloats squares;
    for (std::size_t i = 0; i < NodeFloats::vectors; ++i) {
      const auto outside = [&](int axis) HWY_ATTR {
        const auto lower = hn::LoadU(tag, node.planes[axis][0] + i * NodeFloats::lanes);
        const auto upper = hn::LoadU(tag, node.planes[axis][1] + i * NodeFloats::lanes);
        return hn::Max(
            hn::Max(hn::MulSub(lower, scales_, point_[axis]), hn::NegMulAdd(upper, scales_, point_[axis])),
            hn::Zero(tag));
      };
      const auto x = outside(0), y = outside(1), z = outside(2);
      squares.vector[i] = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    }
    return make_keys(squares);
  }

  // An upper bound of the key of a box that has a point at `squared_distance`. A key takes a difference,
  // squares and two sums: at most six roundings of 2^-24. The summand covers roundings of numbers next to
  // zero.
  HWY_INLINE std::uint32_t limit(double squared_distance) const {
    const double scaled = squared_distance * scale_ * scale_;
    const double bound = std::min(scaled * (1.0 + 0x1p-20) + 0x1p-100, 0x1p127);
    return std::bit_cast<std::uint32_t>(static_cast<float>(bound)) | Keys::slot_bits;
  }

 private:
  float scale_;
  hn::Vec<NodeFloats::Tag> scales_, point_[3];
};

// Distances in double precision, minus the distance of the whole scene, for points so far away that it is
// nearly all of them.
class FarPointBoxes {
 public:
  HWY_INLINE FarPointBoxes(const Vec3f& p, const WideBvh& bvh)
      : point_(p), nearest_(squared_distance(p, bvh.bounds)) {
    scale_ = 1.0 / std::max(nearest_, 0x1p-1000);
  }
  HWY_INLINE Keys keys(const Node& node) const {
    alignas(64) float keys[node_width];
    for (std::uint32_t slot = 0; slot < node_width; ++slot)
      keys[slot] = static_cast<float>(
          std::max(0.0, squared_distance(point_, child_box(node, slot)) - nearest_) * scale_);
    return make_keys(load<node_width>(keys));
  }
  HWY_INLINE std::uint32_t limit(double squared_distance) const {
    const double bound =
        std::min((squared_distance - nearest_) * scale_ * (1.0 + 0x1p-20) + 0x1p-100, 0x1p127);
    return std::bit_cast<std::uint32_t>(static_cast<float>(std::max(bound, 0.0))) | Keys::slot_bits;
  }

 private:
  Vec3f point_;
  double nearest_, scale_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
