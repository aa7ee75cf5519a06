// A vertex of a triangle in a vector register.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_LOAD_CORNER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_LOAD_CORNER_INL_H
#undef KERF_CONSTRUCTION_LOAD_CORNER_INL_H
#else
#define KERF_CONSTRUCTION_LOAD_CORNER_INL_H
#endif

#include <cstring>

#include <hwy/highway.h>
#include <kerf/mesh.hpp>

#include "simd/box-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// Negative zeros become positive: instruction sets disagree about which zero is the smaller one.
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

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
