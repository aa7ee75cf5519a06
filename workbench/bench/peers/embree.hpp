// Intel Embree, the peer that kerf is compared with. It is optional.
#pragma once

#include <string>
#include <vector>

#include "workbench/bench/peers/engine.hpp"

namespace workbench {

/// The instruction sets that Embree may use on this machine, from the narrowest to the widest: of "sse2",
/// "sse4.2", "avx", "avx2" and "avx512", or "native" where it has no choice. None if CMake did not find
/// Embree.
std::vector<std::string> embree_isas();

/// `embree-high` (spatial splits), `embree-high-robust` and `embree-medium` (object splits), which trace ray
/// by ray, and `embree-high-packet`, which traces 16 rays at a time through the structure of the first. None
/// if CMake did not find Embree. Each engine has a device of its own with `threads` threads, which builds and
/// traces with `isa`, one of `embree_isas`.
std::vector<Engine> embree_engines(unsigned threads, const std::string& isa);

}  // namespace workbench
