// Denormals flushed to zero, as Embree asks for.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace workbench {

/// Flushes denormals to zero in this thread, as long as it lives. Embree's manual asks for that wherever
/// Embree traces ("MXCSR control and status register").
class FlushDenormals {
#if defined(__SSE2__)
 public:
  FlushDenormals() : before_(_mm_getcsr()) {
    _mm_setcsr(before_ | 0x8040u);
  }
  ~FlushDenormals() {
    _mm_setcsr(before_);
  }

 private:
  unsigned before_;
#else
 public:
  FlushDenormals() {}
#endif
};

}  // namespace workbench
