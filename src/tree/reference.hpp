// What builders sort: a part of a triangle, by its box.
#pragma once

#include <cstdint>
#include <type_traits>

#include "math/box3f.hpp"

namespace kerf {

/// A triangle, or the part of it that a spatial split left here, and a box around that part. Half a cache
/// line: the halves are loaded as vectors of four, so the number stands where the fourth component of the
/// lower corner would.
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
