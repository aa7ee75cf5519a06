// Which instruction set's kernels run.
#pragma once

#include <cstddef>
#include <span>

namespace kerf {

/// An instruction set for which kernels have been compiled.
struct Target {
  const char* name;         ///< as Highway calls it: "AVX3", "NEON", ...
  std::size_t table_index;  ///< where its function stands in each dispatch table
};

/// Those that this machine can run, the best first, the fallback last. Found once per process: asking a
/// virtual machine's processor takes some 20 microseconds.
std::span<const Target> supported_targets();

/// The best of them, or the one that the environment variable KERF_TARGET names, if it names one. The
/// variable is read at each call: once per build and per file.
Target choose_target();

/// The function of that target, after `HWY_EXPORT(function)`.
#define KERF_DISPATCH(function, target) (*HWY_DISPATCH_TABLE(function)[(target).table_index])

}  // namespace kerf
