// The triangles of leaves, read anew from meshes that have moved. Compiled once for every instruction set.
#pragma once

#include <cstdint>
#include <span>

#include "layout/pieces.hpp"
#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/geometry.hpp"

namespace kerf {

struct MovedLeaf {
  Box3f box;           ///< around the triangles that have an area, or their pieces
  std::uint32_t flat;  ///< bit i for triangle i: it has no area, or a coordinate that is too large
};

/// What is read at random is fetched for so many leaves together.
inline constexpr std::uint32_t max_leaves_moved = 64;

/// Writes the corners of the triangles of up to `max_leaves_moved` leaves into the leaves, whose memory must
/// be writable, and to `moved` what has become of each. The same on every instruction set.
void move_leaves(Target target, const Pieces& pieces, const Geometry& geometry, const WideBvh& wide,
                 std::span<const ChildLink> leaves, MovedLeaf* moved);

}  // namespace kerf
