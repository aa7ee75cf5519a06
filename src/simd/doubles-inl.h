// Points and vectors in double precision, as many as a vector of doubles has lanes.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_SIMD_DOUBLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_SIMD_DOUBLES_INL_H
#undef KERF_SIMD_DOUBLES_INL_H
#else
#define KERF_SIMD_DOUBLES_INL_H
#endif

#include <hwy/highway.h>
#include <kerf/vec.hpp>

#include "simd/floats-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

struct Vec3Doubles {
  DoubleVector x, y, z;
};
HWY_INLINE Vec3Doubles operator-(const Vec3Doubles& a, const Vec3Doubles& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE DoubleVector dot(const Vec3Doubles& a, const Vec3Doubles& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec3Doubles cross(const Vec3Doubles& a, const Vec3Doubles& b) {
  const auto minor = [](DoubleVector p, DoubleVector q, DoubleVector r, DoubleVector s)
                         HWY_ATTR { return hn::Sub(hn::Mul(p, q), hn::Mul(r, s)); };
  return {minor(a.y, b.z, a.z, b.y), minor(a.z, b.x, a.x, b.z), minor(a.x, b.y, a.y, b.x)};
}

HWY_INLINE Vec3Doubles broadcast_doubles(const Vec3f& a) {
  const DoubleTag tag;
  return {hn::Set(tag, double{a.x}), hn::Set(tag, double{a.y}), hn::Set(tag, double{a.z})};
}
HWY_INLINE DoubleVector load_doubles(const float* p) {
  return hn::PromoteTo(DoubleTag(), hn::LoadU(hn::Rebind<float, DoubleTag>(), p));
}
// x, y and z from three rows of `stride` floats each.
HWY_INLINE Vec3Doubles load_vectors(const float* rows, std::size_t stride) {
  return {load_doubles(rows), load_doubles(rows + stride), load_doubles(rows + 2 * stride)};
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
