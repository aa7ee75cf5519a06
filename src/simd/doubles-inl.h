// Points and vectors in double precision, as many as a vector of doubles has lanes.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_SIMD_DOUBLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_SIMD_DOUBLES_INL_H
#undef KERF_SIMD_DOUBLES_INL_H
#else
#define KERF_SIMD_DOUBLES_INL_H
#endif

#include <cmath>
#include <cstring>

#include <hwy/highway.h>
#include <kerf/vec.hpp>

#include "simd/floats-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

#if HWY_HAVE_FLOAT64

namespace dn = hn;

// A vector of doubles has half as many lanes as one of floats, or eight where vectors are that long.
using DoubleTag = hn::CappedTag<double, 8>;
using DoubleVector = hn::Vec<DoubleTag>;
using DoubleMask = hn::Mask<DoubleTag>;
inline constexpr std::size_t double_lanes = hn::MaxLanes(DoubleTag());

HWY_INLINE DoubleVector load_doubles(const float* p) {
  return hn::PromoteTo(DoubleTag(), hn::LoadU(hn::Rebind<float, DoubleTag>(), p));
}

#else

// Highway 1.0 has no doubles for WebAssembly, whose vectors hold two of them: the compiler's own vectors
// stand in, under the names that Highway gives the operations.
using DoubleVector = double __attribute__((__vector_size__(16)));
using DoubleMask = decltype(DoubleVector() < DoubleVector());
struct DoubleTag {};
inline constexpr std::size_t double_lanes = 2;

HWY_INLINE DoubleVector load_doubles(const float* p) {
  return DoubleVector{double{p[0]}, double{p[1]}};
}

namespace dn {

HWY_INLINE DoubleVector Set(DoubleTag, double x) {
  return DoubleVector{x, x};
}
HWY_INLINE DoubleVector Zero(DoubleTag) {
  return DoubleVector{};
}
HWY_INLINE DoubleVector Load(DoubleTag, const double* p) {
  DoubleVector a;
  std::memcpy(&a, p, sizeof a);
  return a;
}
HWY_INLINE void Store(DoubleVector a, DoubleTag, double* p) {
  std::memcpy(p, &a, sizeof a);
}
HWY_INLINE DoubleVector Add(DoubleVector a, DoubleVector b) {
  return a + b;
}
HWY_INLINE DoubleVector Sub(DoubleVector a, DoubleVector b) {
  return a - b;
}
HWY_INLINE DoubleVector Mul(DoubleVector a, DoubleVector b) {
  return a * b;
}
HWY_INLINE DoubleVector Div(DoubleVector a, DoubleVector b) {
  return a / b;
}
HWY_INLINE DoubleVector Neg(DoubleVector a) {
  return -a;
}
HWY_INLINE DoubleVector Sqrt(DoubleVector a) {
  return DoubleVector{std::sqrt(a[0]), std::sqrt(a[1])};
}
HWY_INLINE DoubleVector Abs(DoubleVector a) {
  return DoubleVector(DoubleMask(a) & (DoubleMask{} + 0x7fffffffffffffff));
}
HWY_INLINE DoubleMask Lt(DoubleVector a, DoubleVector b) {
  return a < b;
}
HWY_INLINE DoubleMask Le(DoubleVector a, DoubleVector b) {
  return a <= b;
}
HWY_INLINE DoubleMask And(DoubleMask a, DoubleMask b) {
  return a & b;
}
HWY_INLINE DoubleVector IfThenElse(DoubleMask mask, DoubleVector a, DoubleVector b) {
  return DoubleVector((mask & DoubleMask(a)) | (~mask & DoubleMask(b)));
}
HWY_INLINE DoubleVector IfThenElseZero(DoubleMask mask, DoubleVector a) {
  return DoubleVector(mask & DoubleMask(a));
}
HWY_INLINE DoubleVector Min(DoubleVector a, DoubleVector b) {
  return IfThenElse(a < b, a, b);
}
HWY_INLINE DoubleVector Max(DoubleVector a, DoubleVector b) {
  return IfThenElse(a < b, b, a);
}

}  // namespace dn

HWY_INLINE std::uint32_t bits(DoubleTag, DoubleMask mask) {
  return (static_cast<std::uint32_t>(mask[0]) & 1u) | (static_cast<std::uint32_t>(mask[1]) & 2u);
}

#endif

struct Vec3Doubles {
  DoubleVector x, y, z;
};
HWY_INLINE Vec3Doubles operator-(const Vec3Doubles& a, const Vec3Doubles& b) {
  return {dn::Sub(a.x, b.x), dn::Sub(a.y, b.y), dn::Sub(a.z, b.z)};
}
HWY_INLINE DoubleVector dot(const Vec3Doubles& a, const Vec3Doubles& b) {
  return dn::Add(dn::Add(dn::Mul(a.x, b.x), dn::Mul(a.y, b.y)), dn::Mul(a.z, b.z));
}
HWY_INLINE Vec3Doubles cross(const Vec3Doubles& a, const Vec3Doubles& b) {
  const auto minor = [](DoubleVector p, DoubleVector q, DoubleVector r, DoubleVector s)
                         HWY_ATTR { return dn::Sub(dn::Mul(p, q), dn::Mul(r, s)); };
  return {minor(a.y, b.z, a.z, b.y), minor(a.z, b.x, a.x, b.z), minor(a.x, b.y, a.y, b.x)};
}

HWY_INLINE Vec3Doubles broadcast_doubles(const Vec3f& a) {
  const DoubleTag tag;
  return {dn::Set(tag, double{a.x}), dn::Set(tag, double{a.y}), dn::Set(tag, double{a.z})};
}
// x, y and z from three rows of `stride` floats each.
HWY_INLINE Vec3Doubles load_vectors(const float* rows, std::size_t stride) {
  return {load_doubles(rows), load_doubles(rows + stride), load_doubles(rows + 2 * stride)};
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
