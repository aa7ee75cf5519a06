// The instruction sets that kernels are compiled for: included before Highway's foreach_target.h.
#pragma once

#define HWY_COMPILE_ALL_ATTAINABLE      // the scalar one where every machine has SSE2, too: tests need it
#define HWY_DISABLED_TARGETS HWY_SSSE3  // such old machines take the scalar one,
#define HWY_BROKEN_EMU128 1             // which is one number at a time under every compiler
