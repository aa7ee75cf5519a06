// How many rays a thread traces at once.
#pragma once

#include <cstddef>

namespace kerf {

/// Enough that the first and the last few rays in flight, which do not fill the core, hardly count.
inline constexpr std::size_t rays_per_batch = 1024;

}  // namespace kerf
