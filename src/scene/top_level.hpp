// Nodes over the boxes of a scene's places.
#pragma once

#include <cstdint>
#include <span>

#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Builds nodes of `width` children over `references`, whose leaves hold one each: leaf i that of
/// `primitives[i]`. Leaves of a node have numbers in a row. Changes the order of the references. On all
/// threads of the task arena that this is called in; the same for any number. Throws `std::bad_alloc`.
WideBvh build_top_level(std::span<Reference> references, std::uint32_t* primitives, std::uint32_t width,
                        Target target);

}  // namespace kerf
