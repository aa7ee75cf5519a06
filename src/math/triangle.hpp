// The box of a triangle, and whether it has an area.
#pragma once

#include <kerf/triangle.hpp>

#include "math/box3f.hpp"
#include "math/predicates.hpp"

namespace kerf {

inline Box3f bounds_of(const Triangle& t) {
  return {min(min(t.v0, t.v1), t.v2), max(max(t.v0, t.v1), t.v2)};
}

/// True for a triangle without area: its corners are in one line. Twice the area is the length of the cross
/// product of two edges; where double precision leaves open whether that is zero, exact arithmetic decides.
inline bool is_degenerate(const Triangle& t) {
  const Vec3d u = difference(t.v1, t.v0), v = difference(t.v2, t.v0);
  const auto differ = [](double a, double b) {
    constexpr double bound = 6.0 / 9007199254740992.0;  // as in `orientation_2d`
    return std::abs(a - b) > bound * (std::abs(a) + std::abs(b));
  };
  if (differ(u.y * v.z, u.z * v.y) || differ(u.z * v.x, u.x * v.z) || differ(u.x * v.y, u.y * v.x))
    return false;
  return t.v0 == t.v1 || t.v1 == t.v2 || t.v2 == t.v0 || collinear(t.v0, t.v1, t.v2);
}

}  // namespace kerf
