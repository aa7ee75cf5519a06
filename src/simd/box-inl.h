// Boxes in vector registers: [lower, -upper], so that one minimum merges two boxes and one maximum intersects
// them. Included once for each instruction set: see subtree.cpp.

#if defined(KERF_SIMD_BOX_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_SIMD_BOX_INL_H
#undef KERF_SIMD_BOX_INL_H
#else
#define KERF_SIMD_BOX_INL_H
#endif

#include <limits>

#include <hwy/highway.h>

#include "tree/reference.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Four = hn::FixedTag<float, 4>;
using FourInts = hn::FixedTag<std::int32_t, 4>;
using Vec4 = hn::Vec<Four>;
constexpr Four four;
constexpr FourInts four_ints;

constexpr hn::FixedTag<std::uint32_t, 4> four_bits;

// A reference's number stands in the fourth lane. Read as a float it is a denormal one, which costs some
// machines a hundred cycles in every sum: without this mask, binning took four times as long.
alignas(32) constexpr std::uint32_t corner_lanes[8] = {~0u, ~0u, ~0u, 0, ~0u, ~0u, ~0u, 0};

alignas(32) constexpr std::uint32_t infinite_fourth_lane[8] = {0, 0, 0, 0x7f800000, 0, 0, 0, 0};
alignas(32) constexpr std::int32_t one_reference_lanes[8] = {0, 0, 0, 1, 0, 0, 0, 0};

constexpr float infinity = std::numeric_limits<float>::infinity();

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
using Eight = hn::FixedTag<float, 8>;
constexpr Eight eight;
constexpr hn::FixedTag<std::uint32_t, 8> eight_bits;
constexpr hn::FixedTag<std::int32_t, 8> eight_ints;

struct SimdBox {
  hn::Vec<Eight> halves;
};
using BoxMask = hn::Mask<Eight>;

HWY_INLINE SimdBox from_halves(Vec4 lower, Vec4 negated_upper) {
  return {hn::Combine(eight, negated_upper, lower)};
}
HWY_INLINE Vec4 lower_of(const SimdBox& box) {
  return hn::LowerHalf(four, box.halves);
}
HWY_INLINE Vec4 negated_upper_of(const SimdBox& box) {
  return hn::UpperHalf(four, box.halves);
}
HWY_INLINE SimdBox empty_box() {
  return {hn::Set(eight, infinity)};
}
HWY_INLINE SimdBox load_bin(const float* from) {
  return {hn::Load(eight, from)};
}
HWY_INLINE void store_bin(const SimdBox& box, float* to) {
  hn::Store(box.halves, eight, to);
}
HWY_INLINE SimdBox merge(const SimdBox& a, const SimdBox& b) {
  return {hn::Min(a.halves, b.halves)};
}
HWY_INLINE SimdBox intersect(const SimdBox& a, const SimdBox& b) {
  return {hn::Max(a.halves, b.halves)};
}
HWY_INLINE SimdBox load_box(const Reference& reference) {
  const auto signs = hn::ConcatUpperLower(eight, hn::Set(eight, -0.0f), hn::Zero(eight));
  const auto bits = hn::BitCast(eight_bits, hn::LoadU(eight, &reference.lower.x));
  const auto corners = hn::BitCast(eight, hn::And(bits, hn::Load(eight_bits, corner_lanes)));
  return {hn::Xor(corners, signs)};
}
// See bins-inl.h: a box that leaves the fourth lane of a bin alone when it is merged into it, and a bin
// with one reference more.
HWY_INLINE SimdBox counted_once(const SimdBox& box) {
  return {hn::Or(box.halves, hn::Load(eight, reinterpret_cast<const float*>(infinite_fourth_lane)))};
}
HWY_INLINE SimdBox count_one(const SimdBox& box) {
  const auto sum = hn::Add(hn::BitCast(eight_ints, box.halves), hn::Load(eight_ints, one_reference_lanes));
  return {hn::BitCast(eight, sum)};
}
// A reference as it stands in memory, to be moved: compilers copy it field by field.
HWY_INLINE SimdBox load_whole(const Reference& reference) {
  return {hn::LoadU(eight, &reference.lower.x)};
}
HWY_INLINE void store_whole(const SimdBox& whole, Reference& to) {
  hn::StoreU(whole.halves, eight, &to.lower.x);
}
HWY_INLINE BoxMask box_mask(float a, float b) {
  return hn::Lt(hn::Set(eight, a), hn::Set(eight, b));
}
HWY_INLINE SimdBox merge_if(BoxMask mask, const SimdBox& a, const SimdBox& b) {
  return {hn::IfThenElse(mask, hn::Min(a.halves, b.halves), a.halves)};
}
HWY_INLINE SimdBox merge_if_not(BoxMask mask, const SimdBox& a, const SimdBox& b) {
  return {hn::IfThenElse(mask, a.halves, hn::Min(a.halves, b.halves))};
}
HWY_INLINE SimdBox move(const SimdBox& box, const SimdBox& step, float times) {
  return {hn::Add(box.halves, hn::Mul(hn::Set(eight, times), step.halves))};
}
HWY_INLINE SimdBox sum(const SimdBox& a, const SimdBox& b) {
  return {hn::Add(a.halves, b.halves)};
}
// The greatest whole numbers not above (box - origin) * scale.
HWY_INLINE SimdBox floor_of_scaled(const SimdBox& box, const SimdBox& origin, const SimdBox& scale) {
  return {hn::Floor(hn::Mul(hn::Sub(box.halves, origin.halves), scale.halves))};
}
// [lower + upper, -(lower + upper)]: the doubled centroid as a box.
HWY_INLINE SimdBox centroid_box(const SimdBox& box) {
  return {hn::Sub(box.halves, hn::SwapAdjacentBlocks(box.halves))};
}
#else
struct SimdBox {
  Vec4 lower, negated_upper;
};
using BoxMask = hn::Mask<Four>;

HWY_INLINE SimdBox from_halves(Vec4 lower, Vec4 negated_upper) {
  return {lower, negated_upper};
}
HWY_INLINE Vec4 lower_of(const SimdBox& box) {
  return box.lower;
}
HWY_INLINE Vec4 negated_upper_of(const SimdBox& box) {
  return box.negated_upper;
}
HWY_INLINE SimdBox empty_box() {
  return {hn::Set(four, infinity), hn::Set(four, infinity)};
}
HWY_INLINE SimdBox load_bin(const float* from) {
  return {hn::Load(four, from), hn::Load(four, from + 4)};
}
HWY_INLINE void store_bin(const SimdBox& box, float* to) {
  hn::Store(box.lower, four, to);
  hn::Store(box.negated_upper, four, to + 4);
}
HWY_INLINE SimdBox merge(const SimdBox& a, const SimdBox& b) {
  return {hn::Min(a.lower, b.lower), hn::Min(a.negated_upper, b.negated_upper)};
}
HWY_INLINE SimdBox intersect(const SimdBox& a, const SimdBox& b) {
  return {hn::Max(a.lower, b.lower), hn::Max(a.negated_upper, b.negated_upper)};
}
HWY_INLINE SimdBox load_box(const Reference& reference) {
  const auto corner = [](const float* from) {
    return hn::BitCast(
        four, hn::And(hn::BitCast(four_bits, hn::LoadU(four, from)), hn::Load(four_bits, corner_lanes)));
  };
  return {corner(&reference.lower.x), hn::Neg(corner(&reference.upper.x))};
}
HWY_INLINE SimdBox counted_once(const SimdBox& box) {
  const Vec4 lane = hn::Load(four, reinterpret_cast<const float*>(infinite_fourth_lane));
  return {hn::Or(box.lower, lane), box.negated_upper};
}
HWY_INLINE SimdBox count_one(const SimdBox& box) {
  const auto sum = hn::Add(hn::BitCast(four_ints, box.lower), hn::Load(four_ints, one_reference_lanes));
  return {hn::BitCast(four, sum), box.negated_upper};
}
HWY_INLINE SimdBox load_whole(const Reference& reference) {
  return {hn::LoadU(four, &reference.lower.x), hn::LoadU(four, &reference.upper.x)};
}
HWY_INLINE void store_whole(const SimdBox& whole, Reference& to) {
  hn::StoreU(whole.lower, four, &to.lower.x);
  hn::StoreU(whole.negated_upper, four, &to.upper.x);
}
HWY_INLINE BoxMask box_mask(float a, float b) {
  return hn::Lt(hn::Set(four, a), hn::Set(four, b));
}
HWY_INLINE SimdBox merge_if(BoxMask mask, const SimdBox& a, const SimdBox& b) {
  return {hn::IfThenElse(mask, hn::Min(a.lower, b.lower), a.lower),
          hn::IfThenElse(mask, hn::Min(a.negated_upper, b.negated_upper), a.negated_upper)};
}
HWY_INLINE SimdBox merge_if_not(BoxMask mask, const SimdBox& a, const SimdBox& b) {
  return merge_if(hn::Not(mask), a, b);
}
HWY_INLINE SimdBox move(const SimdBox& box, const SimdBox& step, float times) {
  return {hn::Add(box.lower, hn::Mul(hn::Set(four, times), step.lower)),
          hn::Add(box.negated_upper, hn::Mul(hn::Set(four, times), step.negated_upper))};
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

HWY_INLINE Vec4 doubled_centroid(const SimdBox& box) {
  return hn::Sub(lower_of(box), negated_upper_of(box));
}

// Whether the box holds no point.
HWY_INLINE bool is_empty(const SimdBox& box) {
  const auto outside = hn::Gt(hn::Add(lower_of(box), negated_upper_of(box)), hn::Zero(four));
  return !hn::AllFalse(four, hn::And(outside, hn::FirstN(four, 3)));
}

HWY_INLINE Box3f to_box3f(const SimdBox& box) {
  alignas(16) float lower[4], upper[4];
  hn::Store(lower_of(box), four, lower);
  hn::Store(hn::Neg(negated_upper_of(box)), four, upper);
  return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
}

HWY_INLINE SimdBox to_simd_box(const Box3f& box) {
  alignas(16) const float lower[4] = {box.lower.x, box.lower.y, box.lower.z, 0.0f};
  alignas(16) const float negated_upper[4] = {-box.upper.x, -box.upper.y, -box.upper.z, 0.0f};
  return from_halves(hn::Load(four, lower), hn::Load(four, negated_upper));
}

// Writes box and number as the one vector store that they are.
HWY_INLINE void store_reference(const SimdBox& box, std::uint32_t primitive, Reference& to) {
  hn::StoreU(lower_of(box), four, &to.lower.x);
  hn::StoreU(hn::Neg(negated_upper_of(box)), four, &to.upper.x);
  to.primitive = primitive;
}

HWY_INLINE void exchange(Reference& a, Reference& b) {
  const SimdBox whole = load_whole(a);
  store_whole(load_whole(b), a);
  store_whole(whole, b);
}

// The half areas of three boxes, in three lanes.
HWY_INLINE Vec4 half_areas(const SimdBox& a, const SimdBox& b, const SimdBox& c) {
  const Vec4 ea = hn::Add(lower_of(a), negated_upper_of(a));
  const Vec4 eb = hn::Add(lower_of(b), negated_upper_of(b));
  const Vec4 ec = hn::Add(lower_of(c), negated_upper_of(c));
  // Transposed: one vector each of the extents along x, y and z.
  const Vec4 ac_low = hn::InterleaveLower(four, ea, ec), bb_low = hn::InterleaveLower(four, eb, eb);
  const Vec4 ac_high = hn::InterleaveUpper(four, ea, ec), bb_high = hn::InterleaveUpper(four, eb, eb);
  const Vec4 x = hn::InterleaveLower(four, ac_low, bb_low);
  const Vec4 y = hn::InterleaveUpper(four, ac_low, bb_low);
  const Vec4 z = hn::InterleaveLower(four, ac_high, bb_high);
  return hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
}

HWY_INLINE float half_area_of(const SimdBox& box) {
  alignas(16) float areas[4];
  hn::Store(half_areas(box, box, box), four, areas);
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

#endif  // per target
