// Rays aimed at vertices and edges of closed surfaces: none may slip through.
#pragma once

#include <cstdint>

namespace kerf::cuda {

/// Traces about `total` rays, each for its closest hit and for any, on surfaces of all kinds; half of the
/// surfaces' hierarchies are built on the device. Prints what was found; false if a ray leaks or a hit is not
/// the library's.
bool bench_aimed_rays(std::uint64_t total);

}  // namespace kerf::cuda
