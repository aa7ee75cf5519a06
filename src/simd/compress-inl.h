// Some lanes of a vector, moved to the front.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_SIMD_COMPRESS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_SIMD_COMPRESS_INL_H
#undef KERF_SIMD_COMPRESS_INL_H
#else
#define KERF_SIMD_COMPRESS_INL_H
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "simd/floats-inl.h"
#include "simd/targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if KERF_FLOAT_LANES == 8
struct FrontLanes {
  std::uint8_t lane[256][8];  // for each set of lanes, its lanes from 0 up
};
constexpr FrontLanes front_lanes = [] {
  FrontLanes table{};
  for (std::size_t set = 0; set < 256; ++set) {
    std::size_t count = 0;
    for (std::uint8_t lane = 0; lane < 8; ++lane) {
      if (set >> lane & 1) table.lane[set][count++] = lane;
    }
  }
  return table;
}();
#endif

#if KERF_FLOAT_LANES == 8
// Moves the lanes of `set`, a bit for each, to the front. Highway's own function has a table of 1 KiB for
// eight lanes, which GCC 12 copies to the stack at each call: that took a third of the time of a ray.
template <class V>
HWY_INLINE V compress_set(V v, std::uint32_t set) {
  const hn::DFromV<V> tag;
  const hn::RebindToUnsigned<hn::DFromV<V>> integers;
  const hn::Rebind<std::uint8_t, hn::DFromV<V>> bytes;
  const auto lanes = hn::PromoteTo(integers, hn::LoadU(bytes, front_lanes.lane[set]));
  return hn::TableLookupLanes(v, hn::IndicesFromVec(tag, lanes));
}
#endif

// Moves the lanes that `mask` has to the front.
template <class V, class M>
HWY_INLINE V compress(V v, M mask) {
  const hn::DFromV<V> tag;
#if KERF_FLOAT_LANES == 8
  return compress_set(v, bits(tag, hn::RebindMask(tag, mask)));
#else
  return hn::Compress(v, hn::RebindMask(tag, mask));
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
