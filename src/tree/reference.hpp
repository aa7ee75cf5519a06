// References: what builders sort.
#pragma once

#include <cstdint>
#include <type_traits>

#include "math/box3f.hpp"

namespace kerf {

/// A triangle, or a part of it that spatial splits made, and the box of that part. Takes half a cache line.
/// Both halves are loaded as vectors of four floats, so that the number stands in the fourth lane of the
/// lower corner.
struct alignas(16) Reference {
  Vec3f lower;
  std::uint32_t primitive = 0;  ///< the triangle's number in the `Geometry`
  Vec3f upper;
  std::uint32_t unused = 0;

  Reference() = default;
  Reference(const Box3f& box, std::uint32_t id) : lower(box.lower), primitive(id), upper(box.upper) {}

  Box3f bounds() const { return {lower, upper}; }
};
static_assert(sizeof(Reference) == 32 && std::is_trivially_copyable_v<Reference>);

}  // namespace kerf
