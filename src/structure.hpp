// What a `Bvh` holds.
#pragma once

#include <vector>

#include <kerf/bvh.hpp>

#include "kernel/wide_bvh.hpp"

namespace kerf {

struct Kernels;

struct Bvh::Structure {
  WideBvh wide;
  std::vector<std::uint32_t> first_triangles;  // of each mesh, see Geometry
  BvhStatistics statistics;
  const Kernels* kernels =
      nullptr;  // those of this machine's instruction set; null for a hierarchy of nothing
};

}  // namespace kerf
