// Intel Embree, the peer that kerf is compared with. It is optional.
#pragma once

#include <vector>

#include "workbench/bench/peers/engine.hpp"

namespace workbench {

/// `embree-high` (spatial splits), `embree-high-robust` and `embree-medium` (object splits), which trace ray
/// by ray, and `embree-high-packet`, which traces 16 rays at a time through the structure of the first. None
/// if CMake did not find Embree. Each engine has a device of its own with `threads` threads.
std::vector<Engine> embree_engines(unsigned threads);

}  // namespace workbench
