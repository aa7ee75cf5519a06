// What kernels that trace rays share.
#pragma once

#include "triangle_test.hpp"

namespace kerf::cuda {

/// No way from a root to a leaf has more nodes, see `max_tree_depth` of the library.
inline constexpr std::uint32_t max_depth = 96;

/// What a traversal did; only counting instantiations write it.
struct Counters {
  std::uint32_t nodes = 0, triangles = 0;
};

/// True where some lane of the warp that runs this together says so.
KERF_CUDA_INLINE bool any_lane(bool said) {
#ifdef __CUDA_ARCH__
  return __any_sync(__activemask(), said) != 0;
#else
  return said;
#endif
}

}  // namespace kerf::cuda
