// A ray in the form in which its line is tested against boxes.
#pragma once

#include <algorithm>

#include <kerf/ray.hpp>

#include "math/predicates.hpp"

namespace kerf {

/// For a ray in the plane of a face, 0 * infinity is not a number, and comparisons with that leave the face
/// out.
struct PreparedLine {
  Vec3f origin, direction;
  Vec3d inverse;
  float t_min, t_max;

  explicit PreparedLine(const Ray& ray)
      : origin(ray.origin),
        direction(ray.direction),
        inverse{1.0 / ray.direction.x, 1.0 / ray.direction.y, 1.0 / ray.direction.z},
        t_min(std::max(ray.t_min, 0.0f)),
        t_max(ray.t_max) {}
};

}  // namespace kerf
