// The way of a ray, to count what it meets: a statistic, so that neither edges nor roundings matter.
#pragma once

#include <algorithm>
#include <limits>

#include <kerf/ray.hpp>
#include <kerf/triangle.hpp>

#include "math/box3f.hpp"
#include "math/vec3f.hpp"

namespace kerf {

/// The points of a ray from `t_min` to `t_max`.
class Way {
 public:
  explicit Way(const Ray& ray) : ray_(ray) {
    for (int axis = 0; axis < 3; ++axis) inverse_[axis] = 1.0f / ray.direction[axis];
  }

  float t_max() const { return ray_.t_max; }

  /// The t where it enters the box; infinite if it does not. Along an axis where the direction is 0, the
  /// ratios may be no numbers: such an axis counts as met.
  float enter(const Box3f& box) const {
    float enter = ray_.t_min, leave = ray_.t_max;
    for (int axis = 0; axis < 3; ++axis) {
      const float lower = (box.lower[axis] - ray_.origin[axis]) * inverse_[axis];
      const float upper = (box.upper[axis] - ray_.origin[axis]) * inverse_[axis];
      enter = std::max(enter, std::min(lower, upper));
      leave = std::min(leave, std::max(lower, upper));
    }
    return enter <= leave ? enter : std::numeric_limits<float>::infinity();
  }

  bool meets(const Box3f& box) const { return enter(box) != std::numeric_limits<float>::infinity(); }

  /// Ends at the triangle if it meets it (Möller & Trumbore 1997, "Fast, Minimum Storage Ray/Triangle
  /// Intersection").
  void end_at(const Triangle& triangle) {
    const Vec3f first = triangle.v1 - triangle.v0, second = triangle.v2 - triangle.v0;
    const Vec3f p = cross(ray_.direction, second);
    const float inverse = 1.0f / dot(first, p);
    const Vec3f from = ray_.origin - triangle.v0;
    const float u = inverse * dot(from, p);
    const Vec3f q = cross(from, first);
    const float v = inverse * dot(ray_.direction, q);
    const float t = inverse * dot(second, q);
    if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f && t >= ray_.t_min && t < ray_.t_max) ray_.t_max = t;
  }

 private:
  Ray ray_;
  Vec3f inverse_;
};

}  // namespace kerf
