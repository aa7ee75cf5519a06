// Boxes and order of the children of a wide node.
#pragma once

#include <cstdint>

#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {

/// Writes the boxes of `count` children, one per slot, and for each octant of directions their order from
/// near to far. The order is that of their centers along the octant's diagonal; at the same distance the
/// lower slot comes first, and unused slots come last. The same on every instruction set.
template <std::uint32_t width>
void write_children(Target target, const BinaryNode* const* children, std::uint32_t count,
                    WideNode<width>& node);

}  // namespace kerf
