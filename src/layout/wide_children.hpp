// What a wide node says of its children's boxes.
#pragma once

#include <cstdint>

#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {

/// Writes the boxes of `count` children, one a slot, and for each octant of directions the order in which
/// they come: from near to far, by how far along the octant's diagonal their centers lie; of those equally
/// far the lower slot first, unused ones last. The same on every instruction set.
void write_children(Target target, const BinaryNode* const* children, std::uint32_t count, WideNode& node);

}  // namespace kerf
