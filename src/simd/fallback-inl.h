// The fallback, for machines of before 2008, is compiled for size: loops over the four lanes of its vectors
// would be unrolled, to twice the code. Included behind <hwy/highway.h>, before all other kernels:
// the fallback is the last target of a file. One that is the only target is no fallback.
#if HWY_TARGET == HWY_STATIC_TARGET && (HWY_TARGETS & (HWY_TARGETS - 1)) != 0
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O2")
#endif
#endif
