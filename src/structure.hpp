// What a `Bvh` holds.
#pragma once

#include <algorithm>
#include <vector>

#include <kerf/bvh.hpp>

#include "layout/wide_bvh.hpp"

namespace kerf {

struct Kernels;

struct Bvh::Structure {
  WideBvh wide;
  std::vector<std::uint32_t> first_triangles;  // of each mesh, see Geometry
  BvhStatistics statistics;
  const Kernels* kernels =
      nullptr;  // those of this machine's instruction set; null for a hierarchy of nothing
};

/// The triangle with number `id`, counted over all meshes.
inline PrimitiveId locate(const Bvh::Structure& structure, std::uint32_t id) {
  const auto& first = structure.first_triangles;
  const auto mesh =
      static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), id) - first.begin() - 1);
  return {id - first[mesh], mesh};
}

}  // namespace kerf
