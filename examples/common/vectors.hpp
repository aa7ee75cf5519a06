// The arithmetic of vectors that the examples need. Programs have their own: kerf takes any.
#pragma once

#include <cmath>

#include <kerf/vec.hpp>

using kerf::Vec3f;

inline Vec3f operator+(const Vec3f& a, const Vec3f& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3f operator-(const Vec3f& a, const Vec3f& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3f operator*(float s, const Vec3f& v) {
  return {s * v.x, s * v.y, s * v.z};
}
inline Vec3f cross(const Vec3f& a, const Vec3f& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float dot(const Vec3f& a, const Vec3f& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3f unit(const Vec3f& v) {
  return (1.0f / std::sqrt(dot(v, v))) * v;
}
