// What a traversal did.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <cstdint>

namespace kerf {

/// Sums over the rays that were counted into it.
struct TraversalCounters {
  std::uint64_t steps = 0;           ///< inner nodes visited
  std::uint64_t leaves = 0;          ///< leaves visited
  std::uint64_t triangle_tests = 0;  ///< triangles tested
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
