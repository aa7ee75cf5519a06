// A triangle near a point, as kernels find it.
#pragma once

#include <cstdint>

#include "layout/wide_bvh.hpp"

namespace kerf {

/// A triangle's point closest to a given one: `(1 - u - v) * v0 + u * v1 + v * v2`.
struct NearTriangle {
  double squared_distance;
  double u, v;
  std::uint32_t id;     ///< the triangle's number in the `Geometry`
  ChildLink leaf;       ///< where it stands, or one of its references,
  std::uint32_t place;  ///< and as which of the leaf's triangles
};

/// Nearest first; at the same distance, the lower number first.
inline bool is_nearer(const NearTriangle& a, const NearTriangle& b) {
  return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance : a.id < b.id;
}

}  // namespace kerf
