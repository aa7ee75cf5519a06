// A `Reference` in vector registers: as a box, and as it stands in memory.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_REFERENCE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_REFERENCE_INL_H
#undef KERF_CONSTRUCTION_SBVH_REFERENCE_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_REFERENCE_INL_H
#endif

#include <hwy/highway.h>

#include "simd/box-inl.h"
#include "tree/reference.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// The whole reference, as compilers do not copy it: they move field by field.
HWY_INLINE SimdBox load_whole(const Reference& reference) {
  return load_floats(&reference.lower.x);
}
HWY_INLINE void store_whole(const SimdBox& whole, Reference& to) {
  store_floats(whole, &to.lower.x);
}

// The reference's number stands in the fourth lane. Read as a float it is denormal, and each sum with a
// denormal costs some machines a hundred cycles: with the number left in, binning took four times as long.
HWY_INLINE SimdBox load_box(const Reference& reference) {
  return box_from_corners(load_whole(reference));
}

// Writes each corner with one vector store.
HWY_INLINE void store_reference(const SimdBox& box, std::uint32_t primitive, Reference& to) {
  hn::StoreU(lower_of(box), f32x4, &to.lower.x);
  hn::StoreU(hn::Neg(negated_upper_of(box)), f32x4, &to.upper.x);
  to.primitive = primitive;
}

HWY_INLINE void exchange(Reference& a, Reference& b) {
  const SimdBox whole = load_whole(a);
  store_whole(load_whole(b), a);
  store_whole(whole, b);
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
