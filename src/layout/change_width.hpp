// From a wide tree to one of nodes of another width: for files that were written on another kind of machine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "layout/wide_bvh.hpp"

namespace kerf {

/// The hierarchy with nodes of `width` children, laid out for the machine at hand. `wide` must be without
/// fault (`check_structure`); its triangles are numbered below `triangles`. Boxes of leaves stay as they are,
/// so that what was split stays split. Throws `Error::bad_format` where no binary tree above the leaves keeps
/// to the maximum depth, which no builder's hierarchy comes to, and `std::bad_alloc`.
WideBvh change_width(const WideBvh& wide, std::size_t triangles, std::uint32_t width);

}  // namespace kerf
