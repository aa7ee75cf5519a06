// How large coordinates of triangles may be.
#pragma once

#include <cmath>

#include <kerf/triangle.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// Below a quarter of the range of floats, sums and differences of two coordinates stay finite.
inline constexpr float coordinate_limit = 0x1p126f;

/// Whether every coordinate is below `coordinate_limit`; false for what is not a number.
inline bool is_in_range(const Vec3f& p) {
  return std::abs(p.x) < coordinate_limit && std::abs(p.y) < coordinate_limit &&
         std::abs(p.z) < coordinate_limit;
}
inline bool is_in_range(const Triangle& t) {
  return is_in_range(t.v0) && is_in_range(t.v1) && is_in_range(t.v2);
}

}  // namespace kerf
