// Boxes in vector registers: [lower, -upper], so that one minimum merges two boxes and one maximum intersects
// them.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_SIMD_BOX_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_SIMD_BOX_INL_H
#undef KERF_SIMD_BOX_INL_H
#else
#define KERF_SIMD_BOX_INL_H
#endif

#include <cstdint>
#include <limits>

#include <hwy/highway.h>

#include "math/box3f.hpp"
#include "simd/targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

static_assert(KERF_FLOAT_LANES >= 4 && hn::MaxLanes(hn::ScalableTag<float>()) == KERF_FLOAT_LANES);

using FloatTag4 = hn::FixedTag<float, 4>;
using IntTag4 = hn::FixedTag<std::int32_t, 4>;
using Float4 = hn::Vec<FloatTag4>;
constexpr FloatTag4 f32x4;
constexpr IntTag4 i32x4;
constexpr hn::FixedTag<std::uint32_t, 4> u32x4;

// Masks the three coordinates of each corner.
alignas(32) constexpr std::uint32_t corner_lanes[8] = {~0u, ~0u, ~0u, 0, ~0u, ~0u, ~0u, 0};

alignas(32) constexpr std::uint32_t infinite_fourth_lane[8] = {0, 0, 0, 0x7f800000, 0, 0, 0, 0};
alignas(32) constexpr std::int32_t one_reference_lanes[8] = {0, 0, 0, 1, 0, 0, 0, 0};

constexpr float infinity = std::numeric_limits<float>::infinity();

#if KERF_FLOAT_LANES >= 8
using FloatTag8 = hn::FixedTag<float, 8>;
constexpr FloatTag8 f32x8;
constexpr hn::FixedTag<std::uint32_t, 8> u32x8;
constexpr hn::FixedTag<std::int32_t, 8> i32x8;

struct SimdBox {
  hn::Vec<FloatTag8> halves;
};
using BoxMask = hn::Mask<FloatTag8>;

HWY_INLINE SimdBox from_halves(Float4 lower, Float4 negated_upper) {
  return {hn::Combine(f32x8, negated_upper, lower)};
}
HWY_INLINE Float4 lower_of(const SimdBox& box) {
  return hn::LowerHalf(f32x4, box.halves);
}
HWY_INLINE Float4 negated_upper_of(const SimdBox& box) {
  return hn::UpperHalf(f32x4, box.halves);
}
HWY_INLINE SimdBox empty_box() {
  return {hn::Set(f32x8, infinity)};
}
HWY_INLINE SimdBox load_bin(const float* from) {
  return {hn::Load(f32x8, from)};
}
HWY_INLINE void store_bin(const SimdBox& box, float* to) {
  hn::Store(box.halves, f32x8, to);
}
HWY_INLINE SimdBox merge(const SimdBox& a, const SimdBox& b) {
  return {hn::Min(a.halves, b.halves)};
}
HWY_INLINE SimdBox intersect(const SimdBox& a, const SimdBox& b) {
  return {hn::Max(a.halves, b.halves)};
}
// Eight floats as they stand in memory.
HWY_INLINE SimdBox load_floats(const float* from) {
  return {hn::LoadU(f32x8, from)};
}
HWY_INLINE void store_floats(const SimdBox& floats, float* to) {
  hn::StoreU(floats.halves, f32x8, to);
}
// The lower and the upper corner as they stand in memory, with anything in the fourth lanes.
HWY_INLINE SimdBox box_from_corners(const SimdBox& corners) {
  const auto signs = hn::ConcatUpperLower(f32x8, hn::Set(f32x8, -0.0f), hn::Zero(f32x8));
  const auto bits = hn::BitCast(u32x8, corners.halves);
  return {hn::Xor(hn::BitCast(f32x8, hn::And(bits, hn::Load(u32x8, corner_lanes))), signs)};
}
// For bins (bins-inl.h): a box that leaves the fourth lane of a bin alone when it is merged into it, and a
// bin with one reference more.
HWY_INLINE SimdBox counted_once(const SimdBox& box) {
  return {hn::Or(box.halves, hn::Load(f32x8, reinterpret_cast<const float*>(infinite_fourth_lane)))};
}
HWY_INLINE SimdBox count_one(const SimdBox& box) {
  const auto sum = hn::Add(hn::BitCast(i32x8, box.halves), hn::Load(i32x8, one_reference_lanes));
  return {hn::BitCast(f32x8, sum)};
}
HWY_INLINE BoxMask box_mask(float a, float b) {
  return hn::Lt(hn::Set(f32x8, a), hn::Set(f32x8, b));
}
HWY_INLINE SimdBox merge_if(BoxMask mask, const SimdBox& a, const SimdBox& b) {
  return {hn::IfThenElse(mask, hn::Min(a.halves, b.halves), a.halves)};
}
HWY_INLINE SimdBox merge_if_not(BoxMask mask, const SimdBox& a, const SimdBox& b) {
  return {hn::IfThenElse(mask, a.halves, hn::Min(a.halves, b.halves))};
}
HWY_INLINE SimdBox move(const SimdBox& box, const SimdBox& step, float times) {
  return {hn::Add(box.halves, hn::Mul(hn::Set(f32x8, times), step.halves))};
}
HWY_INLINE SimdBox sum(const SimdBox& a, const SimdBox& b) {
  return {hn::Add(a.halves, b.halves)};
}
// The largest integers not above (box - origin) * scale.
HWY_INLINE SimdBox floor_of_scaled(const SimdBox& box, const SimdBox& origin, const SimdBox& scale) {
  return {hn::Floor(hn::Mul(hn::Sub(box.halves, origin.halves), scale.halves))};
}
// [lower + upper, -(lower + upper)]: the doubled centroid as a box.
HWY_INLINE SimdBox centroid_box(const SimdBox& box) {
  return {hn::Sub(box.halves, hn::SwapAdjacentBlocks(box.halves))};
}
#else
struct SimdBox {
  Float4 lower, negated_upper;
};
using BoxMask = hn::Mask<FloatTag4>;

HWY_INLINE SimdBox from_halves(Float4 lower, Float4 negated_upper) {
  return {lower, negated_upper};
}
HWY_INLINE Float4 lower_of(const SimdBox& box) {
  return box.lower;
}
HWY_INLINE Float4 negated_upper_of(const SimdBox& box) {
  return box.negated_upper;
}
HWY_INLINE SimdBox empty_box() {
  return {hn::Set(f32x4, infinity), hn::Set(f32x4, infinity)};
}
HWY_INLINE SimdBox load_bin(const float* from) {
  return {hn::Load(f32x4, from), hn::Load(f32x4, from + 4)};
}
HWY_INLINE void store_bin(const SimdBox& box, float* to) {
  hn::Store(box.lower, f32x4, to);
  hn::Store(box.negated_upper, f32x4, to + 4);
}
HWY_INLINE SimdBox merge(const SimdBox& a, const SimdBox& b) {
  return {hn::Min(a.lower, b.lower), hn::Min(a.negated_upper, b.negated_upper)};
}
HWY_INLINE SimdBox intersect(const SimdBox& a, const SimdBox& b) {
  return {hn::Max(a.lower, b.lower), hn::Max(a.negated_upper, b.negated_upper)};
}
HWY_INLINE SimdBox load_floats(const float* from) {
  return {hn::LoadU(f32x4, from), hn::LoadU(f32x4, from + 4)};
}
HWY_INLINE void store_floats(const SimdBox& floats, float* to) {
  hn::StoreU(floats.lower, f32x4, to);
  hn::StoreU(floats.negated_upper, f32x4, to + 4);
}
HWY_INLINE SimdBox box_from_corners(const SimdBox& corners) {
  const auto corner = [](Float4 v) HWY_ATTR {
    return hn::BitCast(f32x4, hn::And(hn::BitCast(u32x4, v), hn::Load(u32x4, corner_lanes)));
  };
  return {corner(corners.lower), hn::Neg(corner(corners.negated_upper))};
}
HWY_INLINE SimdBox counted_once(const SimdBox& box) {
  const Float4 lane = hn::Load(f32x4, reinterpret_cast<const float*>(infinite_fourth_lane));
  return {hn::Or(box.lower, lane), box.negated_upper};
}
HWY_INLINE SimdBox count_one(const SimdBox& box) {
  const auto sum = hn::Add(hn::BitCast(i32x4, box.lower), hn::Load(i32x4, one_reference_lanes));
  return {hn::BitCast(f32x4, sum), box.negated_upper};
}
HWY_INLINE BoxMask box_mask(float a, float b) {
  return hn::Lt(hn::Set(f32x4, a), hn::Set(f32x4, b));
}
HWY_INLINE SimdBox merge_if(BoxMask mask, const SimdBox& a, const SimdBox& b) {
  return {hn::IfThenElse(mask, hn::Min(a.lower, b.lower), a.lower),
          hn::IfThenElse(mask, hn::Min(a.negated_upper, b.negated_upper), a.negated_upper)};
}
HWY_INLINE SimdBox merge_if_not(BoxMask mask, const SimdBox& a, const SimdBox& b) {
  return merge_if(hn::Not(mask), a, b);
}
HWY_INLINE SimdBox move(const SimdBox& box, const SimdBox& step, float times) {
  return {hn::Add(box.lower, hn::Mul(hn::Set(f32x4, times), step.lower)),
          hn::Add(box.negated_upper, hn::Mul(hn::Set(f32x4, times), step.negated_upper))};
}
HWY_INLINE SimdBox sum(const SimdBox& a, const SimdBox& b) {
  return {hn::Add(a.lower, b.lower), hn::Add(a.negated_upper, b.negated_upper)};
}
HWY_INLINE SimdBox floor_of_scaled(const SimdBox& box, const SimdBox& origin, const SimdBox& scale) {
  return {hn::Floor(hn::Mul(hn::Sub(box.lower, origin.lower), scale.lower)),
          hn::Floor(hn::Mul(hn::Sub(box.negated_upper, origin.negated_upper), scale.negated_upper))};
}
HWY_INLINE SimdBox centroid_box(const SimdBox& box) {
  return {hn::Sub(box.lower, box.negated_upper), hn::Sub(box.negated_upper, box.lower)};
}
#endif

HWY_INLINE Float4 doubled_centroid(const SimdBox& box) {
  return hn::Sub(lower_of(box), negated_upper_of(box));
}

// Whether the box holds no point.
HWY_INLINE bool is_empty(const SimdBox& box) {
  const auto outside = hn::Gt(hn::Add(lower_of(box), negated_upper_of(box)), hn::Zero(f32x4));
  return !hn::AllFalse(f32x4, hn::And(outside, hn::FirstN(f32x4, 3)));
}

HWY_INLINE Box3f to_box3f(const SimdBox& box) {
  alignas(16) float lower[4], upper[4];
  hn::Store(lower_of(box), f32x4, lower);
  hn::Store(hn::Neg(negated_upper_of(box)), f32x4, upper);
  return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
}

HWY_INLINE SimdBox to_simd_box(const Box3f& box) {
  alignas(16) const float lower[4] = {box.lower.x, box.lower.y, box.lower.z, 0.0f};
  alignas(16) const float negated_upper[4] = {-box.upper.x, -box.upper.y, -box.upper.z, 0.0f};
  return from_halves(hn::Load(f32x4, lower), hn::Load(f32x4, negated_upper));
}

// The half areas of three boxes, in three lanes.
HWY_INLINE Float4 half_areas(const SimdBox& a, const SimdBox& b, const SimdBox& c) {
  const Float4 ea = hn::Add(lower_of(a), negated_upper_of(a));
  const Float4 eb = hn::Add(lower_of(b), negated_upper_of(b));
  const Float4 ec = hn::Add(lower_of(c), negated_upper_of(c));
  // Transposed: one vector each of the extents along x, y and z.
  const Float4 ac_low = hn::InterleaveLower(f32x4, ea, ec), bb_low = hn::InterleaveLower(f32x4, eb, eb);
  const Float4 ac_high = hn::InterleaveUpper(f32x4, ea, ec), bb_high = hn::InterleaveUpper(f32x4, eb, eb);
  const Float4 x = hn::InterleaveLower(f32x4, ac_low, bb_low);
  const Float4 y = hn::InterleaveUpper(f32x4, ac_low, bb_low);
  const Float4 z = hn::InterleaveLower(f32x4, ac_high, bb_high);
  return hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
}

HWY_INLINE float half_area_of(const SimdBox& box) {
  alignas(16) float areas[4];
  hn::Store(half_areas(box, box, box), f32x4, areas);
  return areas[0];
}

HWY_INLINE float half_area_or_zero(const SimdBox& box) {
  return is_empty(box) ? 0.0f : half_area_of(box);
}

struct ChildBoxes {
  SimdBox left, right;
};

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
