// Bytes of a vector, chosen by another.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_SIMD_LOOKUP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_SIMD_LOOKUP_INL_H
#undef KERF_SIMD_LOOKUP_INL_H
#else
#define KERF_SIMD_LOOKUP_INL_H
#endif

#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Byte i of the result is byte `from[i]` of `v`, where `from` has 16 numbers below 16.
//
// Highway 1.0 takes 16 loads and stores for it in WebAssembly, as the instruction was wrong in V8 until April
// 2021. Exceptions of WebAssembly, which the module needs, came after that.
template <class V>
HWY_INLINE V lookup_bytes(V v, const std::uint8_t* from) {
  const hn::DFromV<V> tag;
  const hn::Repartition<std::uint8_t, hn::DFromV<V>> bytes;
  const auto order = hn::Load(bytes, from);
#ifdef __wasm_simd128__
  return hn::BitCast(tag, decltype(order){wasm_i8x16_swizzle(hn::BitCast(bytes, v).raw, order.raw)});
#else
  return hn::BitCast(tag, hn::TableLookupBytes(hn::BitCast(bytes, v), order));
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
