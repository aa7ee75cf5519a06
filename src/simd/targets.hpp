// The one file that knows instruction sets ("targets" in Highway): for which of them kernels are compiled,
// and what a kernel may ask about the one it is compiled for. Comes before all of Highway; README.md shows
// how.
#pragma once

#ifdef HIGHWAY_HWY_DETECT_TARGETS_H_
#error "simd/targets.hpp must be included before Highway"
#endif

// All that the compiler knows, the fallback included, which tests compare with the others. In WebAssembly
// vectors are part of the program or are not, and a page would load a fallback that never runs.
#ifndef __wasm__
#define HWY_COMPILE_ALL_ATTAINABLE
#endif

// What is better than AVX3 has lower bits and nothing more that kernels use. SSSE3 and SSE2, whose name is
// newer than Highway 1.0: such old machines take the fallback. SVE and RVV: a vector whose size is unknown to
// the compiler can be neither a member nor an element of an array; NEON runs wherever SVE does. KERF_LEFT_OUT
// are those that who builds the library does not want: an option of CMake.
#ifndef KERF_LEFT_OUT
#define KERF_LEFT_OUT 0
#endif
#define KERF_SSE2 (1LL << 14)
#define HWY_DISABLED_TARGETS                                                                            \
  ((HWY_AVX3 - 1) | HWY_SSSE3 | KERF_SSE2 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | \
   (KERF_LEFT_OUT))

// Every aarch64 machine has NEON: nothing is left to be chosen at run time. With a choice Highway would ask
// the compiler for AES instructions, which kernels do not use, some machines lack, and GCC does not inline
// into functions that it makes by itself.
#ifdef __aarch64__
#define TOOLCHAIN_MISS_SYS_AUXV_H
#endif

// The fallback is SCALAR, one number at a time, which every compiler translates correctly. Kernels that need
// vectors of four floats define KERF_FOUR_LANES before they include this, and get EMU128 in its place.
#ifdef KERF_FOUR_LANES
#define HWY_BROKEN_EMU128 0
#else
#define HWY_BROKEN_EMU128 1
#endif

// How many floats fit into a vector of the target at hand: 16, 8, 4 or 1. Whether it fuses a multiplication
// with an addition, HWY_NATIVE_FMA tells. By these two alone do kernels choose between ways to compute the
// same.
#define KERF_FLOAT_LANES (HWY_MAX_BYTES < 16 ? 1 : HWY_MAX_BYTES / 4)

// How many children a node has that the kernels of the target at hand trace: as many as are fastest there
// (docs/decisions/0085).
#define KERF_NODE_WIDTH (KERF_FLOAT_LANES >= 8 ? KERF_FLOAT_LANES : 4)

// WebAssembly's minimum and maximum pass NaNs on and order zeros, for which x86 takes eight instructions.
// Kernels need no more than what SSE does, which is the pseudo-minimum: one instruction there. For Highway to
// use that, it stands in before Highway sees the header of the compiler.
#ifdef __wasm_simd128__
#define __builtin_wasm_min_f32x4(a, b) __builtin_wasm_pmin_f32x4(b, a)
#define __builtin_wasm_max_f32x4(a, b) __builtin_wasm_pmax_f32x4(b, a)
#include <wasm_simd128.h>
#undef __builtin_wasm_min_f32x4
#undef __builtin_wasm_max_f32x4
#endif

#include <hwy/targets.h>

// The versions of a function, in the order of HWY_EXPORT. That one's table can be named in one file alone.
#if HWY_IDE || (HWY_TARGETS & (HWY_TARGETS - 1)) == 0
#define KERF_VERSIONS(function) \
  { &HWY_STATIC_DISPATCH(function) }
#else
#define KERF_VERSIONS(function) \
  { nullptr, HWY_CHOOSE_TARGET_LIST(function), HWY_CHOOSE_FALLBACK(function) }
#endif
