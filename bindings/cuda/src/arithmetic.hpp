// What device code is written in. The same functions compile for the host, where tests compare them with the
// library bit for bit on any machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#ifdef __CUDACC__
#define KERF_CUDA_BOTH __host__ __device__
#define KERF_CUDA_INLINE __host__ __device__ __forceinline__
#define KERF_CUDA_NOINLINE inline __host__ __device__ __noinline__
#else
#define KERF_CUDA_BOTH
#define KERF_CUDA_INLINE inline
#define KERF_CUDA_NOINLINE inline
#endif

namespace kerf::cuda {

// Sixteen bytes, which one instruction loads.
struct alignas(16) Words4 {
  std::uint32_t x, y, z, w;
};

// Through the read-only path: nothing of a hierarchy changes while a kernel runs.
KERF_CUDA_INLINE Words4 load(const Words4* p) {
#ifdef __CUDA_ARCH__
  const uint4 v = __ldg(reinterpret_cast<const uint4*>(p));
  return {v.x, v.y, v.z, v.w};
#else
  return *p;
#endif
}

KERF_CUDA_INLINE float as_float(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return __uint_as_float(bits);
#else
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
#endif
}
KERF_CUDA_INLINE std::uint32_t as_bits(float value) {
#ifdef __CUDA_ARCH__
  return __float_as_uint(value);
#else
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
#endif
}
KERF_CUDA_INLINE double as_double(std::uint64_t bits) {
#ifdef __CUDA_ARCH__
  return __longlong_as_double(static_cast<long long>(bits));
#else
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
#endif
}
KERF_CUDA_INLINE std::uint64_t as_bits(double value) {
#ifdef __CUDA_ARCH__
  return static_cast<std::uint64_t>(__double_as_longlong(value));
#else
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
#endif
}

// a * b + c, rounded once. Nothing else is fused: host and device code are compiled without contraction.
KERF_CUDA_INLINE float fused_multiply_add(float a, float b, float c) {
#ifdef __CUDA_ARCH__
  return __fmaf_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

KERF_CUDA_INLINE double fused_multiply_add(double a, double b, double c) {
#ifdef __CUDA_ARCH__
  return __fma_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

// Of numbers one of which is no number, the other: a box test then leaves that slab out.
KERF_CUDA_INLINE float minimum(float a, float b) {
#ifdef __CUDA_ARCH__
  return fminf(a, b);
#else
  return std::fmin(a, b);
#endif
}
KERF_CUDA_INLINE float maximum(float a, float b) {
#ifdef __CUDA_ARCH__
  return fmaxf(a, b);
#else
  return std::fmax(a, b);
#endif
}

// The extremes of numbers of which one at least is not negative, compared as the integers of their bits:
// these stand in the same order, and the device takes the extreme of three in one instruction. Where the
// result is negative, it may be another negative one of the three.
KERF_CUDA_INLINE float largest_of(float a, float b, float c) {
  const auto x = static_cast<std::int32_t>(as_bits(a)), y = static_cast<std::int32_t>(as_bits(b)),
             z = static_cast<std::int32_t>(as_bits(c));
#ifdef __CUDA_ARCH__
  return as_float(static_cast<std::uint32_t>(__vimax3_s32(x, y, z)));
#else
  const std::int32_t largest = x > y ? x : y;
  return as_float(static_cast<std::uint32_t>(largest > z ? largest : z));
#endif
}
KERF_CUDA_INLINE float smallest_of(float a, float b, float c) {
  const auto x = static_cast<std::int32_t>(as_bits(a)), y = static_cast<std::int32_t>(as_bits(b)),
             z = static_cast<std::int32_t>(as_bits(c));
#ifdef __CUDA_ARCH__
  return as_float(static_cast<std::uint32_t>(__vimin3_s32(x, y, z)));
#else
  const std::int32_t smallest = x < y ? x : y;
  return as_float(static_cast<std::uint32_t>(smallest < z ? smallest : z));
#endif
}

KERF_CUDA_INLINE float absolute(float x) {
  return std::fabs(x);
}
KERF_CUDA_INLINE double absolute(double x) {
  return std::fabs(x);
}
KERF_CUDA_INLINE float one_of(std::uint32_t k, float a, float b, float c) {
  return k == 0 ? a : k == 1 ? b : c;
}
// `std::max` and `std::min`, in what they do with what is no number, too.
template <class T>
KERF_CUDA_INLINE T standard_max(T a, T b) {
  return a < b ? b : a;
}
template <class T>
KERF_CUDA_INLINE T standard_min(T a, T b) {
  return b < a ? b : a;
}

/// 1 / x for an x that is neither tiny nor huge, to two units of 2^-24.
KERF_CUDA_INLINE float near_reciprocal(float x) {
#ifdef __CUDA_ARCH__
  float result;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(result) : "f"(x));
  return result;
#else
  return 1.0f / x;
#endif
}

/// The next larger float; not for the largest.
KERF_CUDA_INLINE float next_after(float x) {
  if (x == 0.0f) return as_float(1u);
  return as_float(x > 0.0f ? as_bits(x) + 1 : as_bits(x) - 1);
}

/// a / d and b / d, each rounded once but for the sign of a zero, and about 1 / d. The magnitude of d must
/// lie in [2^-100, 2^100], those of a and b must not exceed it.
struct Quotients {
  float a, b, inverse;
};
KERF_CUDA_INLINE Quotients divide_both(float a, float b, float d) {
#ifdef __CUDA_ARCH__
  // What the device does for one division, with one reciprocal for both. Only where a quotient or what it
  // leaves might not be a normal number, the division itself is asked.
  constexpr float least = 0x1p-60f;
  const float inverse = near_reciprocal(d);
  const float better = __fmaf_rn(inverse, __fmaf_rn(-d, inverse, 1.0f), inverse);
  const auto quotient = [&](float x) {
    const float q = __fmul_rn(x, better);
    return __fmaf_rn(better, __fmaf_rn(-q, d, x), q);
  };
  const auto is_small = [](float x) { return fabsf(x) < least && x != 0.0f; };
  Quotients result{quotient(a), quotient(b), inverse};
  if (is_small(a) || is_small(b)) {
    result.a = __fdiv_rn(a, d);
    result.b = __fdiv_rn(b, d);
  }
  return result;
#else
  return {a / d, b / d, 1.0f / d};
#endif
}

// Of the highest bit that is set; there must be one.
KERF_CUDA_INLINE int highest_bit(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return 31 - __clz(static_cast<int>(bits));
#else
  return 31 - __builtin_clz(bits);
#endif
}

}  // namespace kerf::cuda
