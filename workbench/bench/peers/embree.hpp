// Intel Embree, the peer that kerf is measured beside. Optional: CMake finds it, or it is absent.
#pragma once

#include <vector>

#include "workbench/bench/peers/engine.hpp"

namespace workbench {

/// `embree-high` (spatial splits), `embree-high-robust` and `embree-medium` (object splits), each ray by ray;
/// over the structure of the first also `embree-high-packet`, 16 rays at a time. None if Embree is absent.
/// Each engine has a device of its own with `threads` threads.
std::vector<Engine> embree_engines(unsigned threads);

}  // namespace workbench
