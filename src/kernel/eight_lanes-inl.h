// Eight floats, in as many vectors as the instruction set at hand needs. Included once per instruction set.

#if defined(KERF_EIGHT_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_EIGHT_LANES_INL
#undef KERF_EIGHT_LANES_INL
#else
#define KERF_EIGHT_LANES_INL
#endif

#include <hwy/highway.h>

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

struct Eight {
  FloatVector part[vector_count];
};

HWY_INLINE Eight load(const float* p) {
  Eight r;
  for (std::size_t i = 0; i < vector_count; ++i) r.part[i] = hn::LoadU(FloatTag(), p + i * vector_lanes);
  return r;
}
HWY_INLINE Eight broadcast(float x) {
  Eight r;
  for (std::size_t i = 0; i < vector_count; ++i) r.part[i] = hn::Set(FloatTag(), x);
  return r;
}
HWY_INLINE void store(const Eight& a, float* p) {
  for (std::size_t i = 0; i < vector_count; ++i) hn::StoreU(a.part[i], FloatTag(), p + i * vector_lanes);
}

#define KERF_EIGHT_BINARY(name, operation)                                                      \
  HWY_INLINE Eight name(const Eight& a, const Eight& b) {                                       \
    Eight r;                                                                                    \
    for (std::size_t i = 0; i < vector_count; ++i) r.part[i] = operation(a.part[i], b.part[i]); \
    return r;                                                                                   \
  }
KERF_EIGHT_BINARY(operator+, hn::Add)
KERF_EIGHT_BINARY(operator-, hn::Sub)
KERF_EIGHT_BINARY(operator*, hn::Mul)
KERF_EIGHT_BINARY(minimum, hn::Min)
KERF_EIGHT_BINARY(maximum, hn::Max)
#undef KERF_EIGHT_BINARY

// a * b + c, fused where the instruction set can: only where either result will do.
HWY_INLINE Eight multiply_add(const Eight& a, const Eight& b, const Eight& c) {
  Eight r;
  for (std::size_t i = 0; i < vector_count; ++i) r.part[i] = hn::MulAdd(a.part[i], b.part[i], c.part[i]);
  return r;
}

HWY_INLINE std::uint32_t bits(hn::Mask<FloatTag> mask) {
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(FloatTag(), mask, bytes);
  return bytes[0];
}

// Bit i says whether a[i] <= b[i].
HWY_INLINE std::uint32_t less_or_equal(const Eight& a, const Eight& b) {
  std::uint32_t r = 0;
  for (std::size_t i = 0; i < vector_count; ++i) {
    r |= bits(hn::Le(a.part[i], b.part[i])) << (i * vector_lanes);
  }
  return r;
}
HWY_INLINE std::uint32_t less(const Eight& a, const Eight& b) {
  std::uint32_t r = 0;
  for (std::size_t i = 0; i < vector_count; ++i)
    r |= bits(hn::Lt(a.part[i], b.part[i])) << (i * vector_lanes);
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

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
