// The boxes of a row of triangles. Compiled once for every instruction set.
#pragma once

#include <cstdint>

#include <kerf/build.hpp>

#include "math/coordinate_limit.hpp"
#include "simd/dispatch.hpp"
#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Triangles `begin .. end - 1` of a mesh, the first of which has the number `first_id` in the geometry.
struct TriangleRow {
  std::uint32_t mesh, begin, end, first_id;
};

struct ReadTriangles {
  static constexpr std::uint32_t nothing_wrong = 0xffffffffu;

  std::uint32_t count = 0;              ///< of references written
  std::uint32_t non_finite = 0;         ///< number of triangles skipped because a coordinate is too large
  std::uint32_t wrong = nothing_wrong;  ///< number of the first triangle that is refused; reading stops there
  Box3f box, doubled_centroids;         ///< of the references, as in `NodeInput`
};

/// Writes a reference for each triangle of the row that has an area. Stops at one with an index that names no
/// vertex, and stops at or skips one with a coordinate that is not below `coordinate_limit`.
ReadTriangles read_triangles(Target target, const Geometry& geometry, const TriangleRow& row,
                             NonFinite non_finite, Reference* references);

}  // namespace kerf
