// Arithmetic on axis-aligned boxes.
#pragma once

#include <kerf/vec.hpp>

#include "math/vec3f.hpp"

namespace kerf {

constexpr Box3f merge(const Box3f& a, const Box3f& b) {
  return {min(a.lower, b.lower), max(a.upper, b.upper)};
}
constexpr Box3f merge(const Box3f& a, const Vec3f& p) {
  return {min(a.lower, p), max(a.upper, p)};
}
constexpr Box3f intersect(const Box3f& a, const Box3f& b) {
  return {max(a.lower, b.lower), min(a.upper, b.upper)};
}
constexpr Vec3f extent(const Box3f& box) {
  return box.upper - box.lower;
}

/// Half the surface area, which is all that ratios of areas need. 0 for an empty box.
constexpr float half_area(const Box3f& box) {
  if (box.empty()) return 0.0f;
  const Vec3f e = extent(box);
  return e.x * (e.y + e.z) + e.y * e.z;
}

constexpr bool contains(const Box3f& outer, const Box3f& inner) {
  return outer.lower.x <= inner.lower.x && outer.lower.y <= inner.lower.y && outer.lower.z <= inner.lower.z &&
         outer.upper.x >= inner.upper.x && outer.upper.y >= inner.upper.y && outer.upper.z >= inner.upper.z;
}

}  // namespace kerf
