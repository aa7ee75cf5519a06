// Arithmetic on the library's vectors and boxes, for scenes, cameras and pictures. Every operation rounds
// once per component; nothing is fused.
#pragma once

#include <algorithm>
#include <cmath>

#include <kerf/vec.hpp>

namespace workbench {

using kerf::Box3f;
using kerf::Vec3f;

constexpr Vec3f operator+(const Vec3f& a, const Vec3f& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3f operator-(const Vec3f& a, const Vec3f& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3f operator*(float s, const Vec3f& a) {
  return {a.x * s, a.y * s, a.z * s};
}

constexpr float dot(const Vec3f& a, const Vec3f& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3f cross(const Vec3f& a, const Vec3f& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(const Vec3f& a) {
  return std::sqrt(dot(a, a));
}
inline Vec3f normalize(const Vec3f& a) {
  return (1.0f / length(a)) * a;
}
inline bool is_finite(const Vec3f& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// The smallest box around `box` and `p`.
constexpr Box3f merge(const Box3f& box, const Vec3f& p) {
  return {{std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)},
          {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)}};
}
constexpr Vec3f extent(const Box3f& box) {
  return box.upper - box.lower;
}

}  // namespace workbench
