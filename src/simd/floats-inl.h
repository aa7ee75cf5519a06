// Eight floats or sixteen, in as many vectors as the instruction set at hand needs.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_SIMD_FLOATS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_SIMD_FLOATS_INL_H
#undef KERF_SIMD_FLOATS_INL_H
#else
#define KERF_SIMD_FLOATS_INL_H
#endif

#include <cstring>

#include <hwy/highway.h>

#include "simd/targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 8>;
using FloatVector = hn::Vec<FloatTag>;
inline constexpr std::size_t vector_lanes = hn::MaxLanes(FloatTag());
inline constexpr std::size_t vector_count = 8 / vector_lanes;

// Doubles come in vectors of half as many lanes, but for instruction sets whose vectors hold eight.
using DoubleTag = hn::CappedTag<double, 8>;
using DoubleVector = hn::Vec<DoubleTag>;
inline constexpr std::size_t double_lanes = hn::MaxLanes(DoubleTag());
inline constexpr std::size_t double_count = 8 / double_lanes;

template <std::size_t count>
struct Floats {
  using Tag = hn::CappedTag<float, count>;
  static constexpr std::size_t lanes = hn::MaxLanes(Tag()), parts = count / lanes;
  hn::Vec<Tag> part[parts];
};
using Eight = Floats<8>;
using Sixteen = Floats<16>;

template <std::size_t count = 8>
HWY_INLINE Floats<count> load(const float* p) {
  using F = Floats<count>;
  F r;
  for (std::size_t i = 0; i < F::parts; ++i) r.part[i] = hn::LoadU(typename F::Tag(), p + i * F::lanes);
  return r;
}
template <std::size_t count = 8>
HWY_INLINE Floats<count> broadcast(float x) {
  using F = Floats<count>;
  F r;
  for (std::size_t i = 0; i < F::parts; ++i) r.part[i] = hn::Set(typename F::Tag(), x);
  return r;
}
template <std::size_t count>
HWY_INLINE void store(const Floats<count>& a, float* p) {
  using F = Floats<count>;
  for (std::size_t i = 0; i < F::parts; ++i) hn::StoreU(a.part[i], typename F::Tag(), p + i * F::lanes);
}

#define KERF_FLOATS_BINARY(name, operation)                                                \
  template <std::size_t count>                                                             \
  HWY_INLINE Floats<count> name(const Floats<count>& a, const Floats<count>& b) {          \
    Floats<count> r;                                                                       \
    for (std::size_t i = 0; i < r.parts; ++i) r.part[i] = operation(a.part[i], b.part[i]); \
    return r;                                                                              \
  }
KERF_FLOATS_BINARY(operator+, hn::Add)
KERF_FLOATS_BINARY(operator-, hn::Sub)
KERF_FLOATS_BINARY(operator*, hn::Mul)
KERF_FLOATS_BINARY(minimum, hn::Min)
KERF_FLOATS_BINARY(operator/, hn::Div)
KERF_FLOATS_BINARY(maximum, hn::Max)
#undef KERF_FLOATS_BINARY

template <class Tag>
HWY_INLINE std::uint32_t bits(Tag tag, hn::Mask<Tag> mask) {
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(tag, mask, bytes);
  if constexpr (hn::MaxLanes(Tag()) <= 8) return bytes[0];
  std::uint16_t both;
  std::memcpy(&both, bytes, sizeof both);
  return both;
}

// Bit i says whether a[i] <= b[i].
template <std::size_t count>
HWY_INLINE std::uint32_t less_or_equal(const Floats<count>& a, const Floats<count>& b) {
  std::uint32_t r = 0;
  for (std::size_t i = 0; i < a.parts; ++i)
    r |= bits(typename Floats<count>::Tag(), hn::Le(a.part[i], b.part[i])) << (i * a.lanes);
  return r;
}
HWY_INLINE std::uint32_t less(const Eight& a, const Eight& b) {
  std::uint32_t r = 0;
  for (std::size_t i = 0; i < vector_count; ++i)
    r |= bits(FloatTag(), hn::Lt(a.part[i], b.part[i])) << (i * vector_lanes);
  return r;
}

// Lanes [i * double_lanes, (i + 1) * double_lanes) in double precision.
template <class Lanes = Eight>
HWY_INLINE DoubleVector promote(const Lanes& a, std::size_t i) {
  if constexpr (double_lanes == vector_lanes) {
    return hn::PromoteTo(DoubleTag(), a.part[i]);
  } else {
    const auto part = a.part[i / 2];
    return hn::PromoteTo(DoubleTag(),
                         i % 2 == 0 ? hn::LowerHalf(part) : UpperHalf(hn::Half<FloatTag>(), part));
  }
}

// `difference_of_products` of math/ray_triangle.hpp, to the last bit.
#if HWY_NATIVE_FMA
template <class V>
HWY_INLINE V difference_of_products(V a, V b, V c, V d) {
  const V cd = hn::Mul(c, d);
  return hn::Add(hn::MulSub(a, b, cd), hn::NegMulAdd(c, d, cd));
}
HWY_INLINE Eight difference_of_products(const Eight& a, const Eight& b, const Eight& c, const Eight& d) {
  Eight r;
  for (std::size_t i = 0; i < vector_count; ++i)
    r.part[i] = difference_of_products(a.part[i], b.part[i], c.part[i], d.part[i]);
  return r;
}
#else
// a * b + c rounded once, where the instruction set has no such thing. The product is exact in double
// precision; the sum is rounded to odd there, so that rounding it again does no harm (Boldo & Melquiond 2008,
// "Emulation of a FMA and Correctly Rounded Sums: Proved Algorithms Using Rounding to Odd").
HWY_INLINE Eight fused_multiply_add(const Eight& a, const Eight& b, const Eight& c) {
  const DoubleTag tag;
  const hn::RebindToSigned<DoubleTag> integers;
  alignas(64) float lanes[8];
  for (std::size_t i = 0; i < double_count; ++i) {
    const DoubleVector product = hn::Mul(promote(a, i), promote(b, i)), addend = promote(c, i);
    const DoubleVector sum = hn::Add(product, addend), back = hn::Sub(sum, product);
    const DoubleVector rest = hn::Add(hn::Sub(product, hn::Sub(sum, back)), hn::Sub(addend, back));
    const auto one = hn::Set(integers, 1);
    const auto bits = hn::BitCast(integers, sum);
    const auto towards_rest =
        hn::Or(hn::ShiftRight<63>(hn::BitCast(integers, hn::Xor(sum, rest))), one);  // 1 or -1
    const auto even = hn::Eq(hn::And(bits, one), hn::Zero(integers));
    const auto inexact = hn::RebindMask(integers, hn::Ne(rest, hn::Zero(tag)));
    const auto odd = hn::Add(bits, hn::IfThenElseZero(hn::And(even, inexact), towards_rest));
    const hn::Rebind<float, DoubleTag> narrow;
    hn::StoreU(hn::DemoteTo(narrow, hn::BitCast(tag, odd)), narrow, lanes + i * double_lanes);
  }
  return load(lanes);
}
HWY_INLINE Eight difference_of_products(const Eight& a, const Eight& b, const Eight& c, const Eight& d) {
  const Eight cd = c * d, none = broadcast(0.0f);
  return fused_multiply_add(a, b, none - cd) + fused_multiply_add(none - c, d, cd);
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
