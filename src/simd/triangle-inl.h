// A triangle's corners in vector registers.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_SIMD_TRIANGLE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_SIMD_TRIANGLE_INL_H
#undef KERF_SIMD_TRIANGLE_INL_H
#else
#define KERF_SIMD_TRIANGLE_INL_H
#endif

#include <cstring>

#include <hwy/highway.h>
#include <kerf/mesh.hpp>

#include "math/coordinate_limit.hpp"
#include "simd/box-inl.h"
#include "simd/lookup-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// Anything in the fourth lane. Negative zeros become positive: instruction sets disagree about which zero is
// the smaller one.
HWY_INLINE Float4 load_corner(const TripleView<float>& vertices, std::uint32_t index) {
  const std::byte* const at = vertices.data() + index * vertices.stride();
  Float4 corner;
  if (index + 1 < vertices.size() && vertices.stride() >= 4) {  // reading a fourth float is safe
    corner = hn::LoadU(f32x4, reinterpret_cast<const float*>(at));
  } else {
    alignas(16) float copy[4] = {};
    std::memcpy(copy, at, 3 * sizeof(float));
    corner = hn::Load(f32x4, copy);
  }
  return hn::Add(corner, hn::Zero(f32x4));
}

// Whether the triangle certainly has an area: a component of the cross product of two edges is larger than
// rounding can make of zero. Edges, products and their difference are each off by 2^-24 of themselves, and
// products by the smallest float as well. Together that is less than 2^-21 of what is subtracted.
HWY_INLINE bool has_area(Float4 a, Float4 b, Float4 c) {
  // The bytes of y, z, x and the fourth.
  alignas(16) static constexpr std::uint8_t next[16] = {4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 12, 13, 14, 15};
  const Float4 u = hn::Sub(b, a), v = hn::Sub(c, a);
  const Float4 plus = hn::Mul(u, lookup_bytes(v, next));
  const Float4 minus = hn::Mul(lookup_bytes(u, next), v);
  const Float4 rounding = hn::Add(hn::Mul(hn::Add(hn::Abs(plus), hn::Abs(minus)), hn::Set(f32x4, 0x1p-20f)),
                                  hn::Set(f32x4, 0x1p-120f));
  const auto is_more = hn::Gt(hn::Abs(hn::Sub(plus, minus)), rounding);
  return !hn::AllFalse(f32x4, hn::And(is_more, hn::FirstN(f32x4, 3)));
}

// Whether every coordinate is below `coordinate_limit`; false for what is not a number. The fourth lanes hold
// numbers that are.
HWY_INLINE bool is_in_range(Float4 a, Float4 b, Float4 c) {
  const Float4 limit = hn::Set(f32x4, coordinate_limit);
  return hn::AllTrue(f32x4, hn::And(hn::And(hn::Lt(hn::Abs(a), limit), hn::Lt(hn::Abs(b), limit)),
                                    hn::Lt(hn::Abs(c), limit)));
}

HWY_INLINE SimdBox bounds_of(Float4 a, Float4 b, Float4 c) {
  return from_halves(hn::Min(hn::Min(a, b), c), hn::Neg(hn::Max(hn::Max(a, b), c)));
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
