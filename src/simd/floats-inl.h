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

static_assert(hn::MaxLanes(hn::ScalableTag<float>()) == KERF_FLOAT_LANES);

using FloatTag = hn::CappedTag<float, 8>;
using FloatVector = hn::Vec<FloatTag>;
inline constexpr std::size_t vector_lanes = hn::MaxLanes(FloatTag());

// Where one vector suffices there is no loop, not even one of a single turn: with loops GCC keeps structures
// of several of these in memory.
template <std::size_t count>
struct Floats {
  using Tag = hn::CappedTag<float, count>;
  static constexpr std::size_t lanes = hn::MaxLanes(Tag()), vectors = count / lanes;
  hn::Vec<Tag> vector[vectors];
};
using Float8 = Floats<8>;

template <std::size_t count = 8>
HWY_INLINE Floats<count> load(const float* p) {
  using F = Floats<count>;
  F r;
  r.vector[0] = hn::LoadU(typename F::Tag(), p);
  for (std::size_t i = 1; i < F::vectors; ++i) r.vector[i] = hn::LoadU(typename F::Tag(), p + i * F::lanes);
  return r;
}
template <std::size_t count = 8>
HWY_INLINE Floats<count> broadcast(float x) {
  using F = Floats<count>;
  F r;
  r.vector[0] = hn::Set(typename F::Tag(), x);
  for (std::size_t i = 1; i < F::vectors; ++i) r.vector[i] = hn::Set(typename F::Tag(), x);
  return r;
}
template <std::size_t count>
HWY_INLINE void store(const Floats<count>& a, float* p) {
  using F = Floats<count>;
  for (std::size_t i = 0; i < F::vectors; ++i) hn::StoreU(a.vector[i], typename F::Tag(), p + i * F::lanes);
}

#define KERF_FLOATS_BINARY(name, operation)                                                        \
  template <std::size_t count>                                                                     \
  HWY_INLINE Floats<count> name(const Floats<count>& a, const Floats<count>& b) {                  \
    Floats<count> r;                                                                               \
    r.vector[0] = operation(a.vector[0], b.vector[0]);                                             \
    for (std::size_t i = 1; i < r.vectors; ++i) r.vector[i] = operation(a.vector[i], b.vector[i]); \
    return r;                                                                                      \
  }
KERF_FLOATS_BINARY(operator+, hn::Add)
KERF_FLOATS_BINARY(operator-, hn::Sub)
KERF_FLOATS_BINARY(operator*, hn::Mul)
KERF_FLOATS_BINARY(minimum, hn::Min)
KERF_FLOATS_BINARY(operator/, hn::Div)
KERF_FLOATS_BINARY(maximum, hn::Max)
#undef KERF_FLOATS_BINARY

template <std::size_t count>
HWY_INLINE Floats<count> absolute(const Floats<count>& a) {
  Floats<count> r;
  r.vector[0] = hn::Abs(a.vector[0]);
  for (std::size_t i = 1; i < r.vectors; ++i) r.vector[i] = hn::Abs(a.vector[i]);
  return r;
}

// The larger and the smaller of floats of which the result matters only where none is negative. There the
// order of floats is that of their bits, and integers are compared in one cycle, where floats take up to
// four.
template <class V>
HWY_INLINE V larger_as_bits(V a, V b) {
  const hn::DFromV<V> floats;
  const hn::RebindToSigned<hn::DFromV<V>> integers;
  return hn::BitCast(floats, hn::Max(hn::BitCast(integers, a), hn::BitCast(integers, b)));
}
template <class V>
HWY_INLINE V smaller_as_bits(V a, V b) {
  const hn::DFromV<V> floats;
  const hn::RebindToSigned<hn::DFromV<V>> integers;
  return hn::BitCast(floats, hn::Min(hn::BitCast(integers, a), hn::BitCast(integers, b)));
}

template <class Tag>
HWY_INLINE std::uint32_t bits([[maybe_unused]] Tag tag, hn::Mask<Tag> mask) {
#ifdef __wasm_simd128__  // one instruction, where Highway 1.0 takes five loads and stores
  if constexpr (sizeof(hn::TFromD<Tag>) == 4 && hn::MaxLanes(Tag()) == 4) return wasm_i32x4_bitmask(mask.raw);
#endif
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
  for (std::size_t i = 0; i < a.vectors; ++i)
    r |= bits(typename Floats<count>::Tag(), hn::Le(a.vector[i], b.vector[i])) << (i * a.lanes);
  return r;
}
template <std::size_t count>
HWY_INLINE std::uint32_t less(const Floats<count>& a, const Floats<count>& b) {
  std::uint32_t r = 0;
  for (std::size_t i = 0; i < a.vectors; ++i)
    r |= bits(typename Floats<count>::Tag(), hn::Lt(a.vector[i], b.vector[i])) << (i * a.lanes);
  return r;
}

#if HWY_NATIVE_FMA
// `difference_of_products` of math/ray_triangle.hpp, to the last bit.
template <class V>
HWY_INLINE V difference_of_products(V a, V b, V c, V d) {
  const V cd = hn::Mul(c, d);
  return hn::Add(hn::MulSub(a, b, cd), hn::NegMulAdd(c, d, cd));
}
template <std::size_t count>
HWY_INLINE Floats<count> difference_of_products(const Floats<count>& a, const Floats<count>& b,
                                                const Floats<count>& c, const Floats<count>& d) {
  Floats<count> r;
  r.vector[0] = difference_of_products(a.vector[0], b.vector[0], c.vector[0], d.vector[0]);
  for (std::size_t i = 1; i < r.vectors; ++i)
    r.vector[i] = difference_of_products(a.vector[i], b.vector[i], c.vector[i], d.vector[i]);
  return r;
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
