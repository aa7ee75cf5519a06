// Denormals flushed to zero, for peers that want it.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace workbench {

/// While there is one, in this thread. Embree's manual asks for that wherever Embree traces ("MXCSR control
/// and status register").
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
