// Floating-point arithmetic as IEEE 754 has it by default, whatever the calling thread is set to.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace kerf {

/// While an object lives, its thread rounds to nearest and keeps denormals. Callers may have other modes:
/// renderers flush denormals to zero, as Embree's manual asks, and interval arithmetic rounds upwards. kerf's
/// error bounds hold with neither. Builds also keep integers in lanes of float vectors, and these look like
/// denormals.
///
/// Single rays do without, because it would cost them 2 to 3 %. Their kernels only need rounding to nearest.
class PlainFloatingPoint {
 public:
#if defined(__SSE2__)
  PlainFloatingPoint() : before_(_mm_getcsr()) {
    if ((before_ & modes) != 0) _mm_setcsr(before_ & ~modes);
  }
  ~PlainFloatingPoint() {
    if ((before_ & modes) != 0) _mm_setcsr(before_);
  }

 private:
  static constexpr unsigned modes =
      0x8000u | 0x6000u | 0x0040u;  // flush to zero; rounding; denormals are zeros
  unsigned before_;
#else
  PlainFloatingPoint() {
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~PlainFloatingPoint() {
    std::fesetenv(&before_);
  }

 private:
  std::fenv_t before_;
#endif

 public:
  PlainFloatingPoint(const PlainFloatingPoint&) = delete;
  PlainFloatingPoint& operator=(const PlainFloatingPoint&) = delete;
};

}  // namespace kerf
