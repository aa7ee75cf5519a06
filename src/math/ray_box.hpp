// Conservative ray-box intersection: no box is missed that holds a point of a triangle which the ray hits.
#pragma once

#include <algorithm>
#include <cmath>
#include <kerf/ray.hpp>
#include <limits>

#include "math/vec3f.hpp"

namespace kerf {

/// A ray as box tests see it: along each axis, the ray enters between two planes at `near * inverse + enter`
/// and leaves at `far * inverse + leave`.
///
/// Boxes are in effect grown by a margin on all sides (as in the appendix of Woop, Benthin & Wald 2013),
/// which the two constants carry, so that it costs nothing at the box. It covers every rounding between the
/// exact ray and the computed distances, here and in `intersect_triangle`, in any order and fused or not; Ize
/// 2013 ("Robust BVH Ray Traversal") covers those of the box test alone. In units of 2^-24, with D the
/// largest distance along an axis from the origin to the scene's far side and O the origin's largest
/// coordinate:
///
///     the shear of a triangle's vertices      6 D     (a difference, a quotient, a product, a difference)
///     inverse, the plane's distance, t        3 D
///     plane times inverse, where not fused    1 D + 1 O
///     origin times inverse, the constants             2 O
///     directions lifted to the least          1/4 D
///
/// The triangle's t itself lies in the grown box up to its rounding, so that what is culled by t is culled
/// rightly.
struct RayBoxes {
  Vec3f inverse, enter, leave;

  /// `direction`'s largest component must be in [1, 2), as `PreparedRay` makes it.
  RayBoxes(const Vec3f& origin, const Vec3f& direction, const Box3f& scene) {
    constexpr float unit = 0x1p-24f;
    constexpr float least = 0x1p-26f;  // moves the ray by no more than a quarter of a unit of D
    float distance = 0.0f, coordinate = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      distance = std::max(
          {distance, std::abs(origin[axis] - scene.lower[axis]), std::abs(origin[axis] - scene.upper[axis])});
      coordinate = std::max(coordinate, std::abs(origin[axis]));
    }
    const float margin = unit * (16.0f * distance + 4.0f * coordinate);
    for (int axis = 0; axis < 3; ++axis) {
      const float d = std::copysign(std::max(std::abs(direction[axis]), least), direction[axis]);
      inverse[axis] = 1.0f / d;
      const float product = origin[axis] * inverse[axis], grown = margin * std::abs(inverse[axis]);
      enter[axis] = -product - grown;
      leave[axis] = grown - product;
    }
  }

  /// Where the ray enters the box, or infinity if it misses or the box lies outside [t_min, t_max].
  float entry(const Box3f& box, float t_min, float t_max) const {
    float first = t_min, last = t_max;
    for (int axis = 0; axis < 3; ++axis) {
      const bool positive = inverse[axis] > 0.0f;
      first = std::max(first, (positive ? box.lower : box.upper)[axis] * inverse[axis] + enter[axis]);
      last = std::min(last, (positive ? box.upper : box.lower)[axis] * inverse[axis] + leave[axis]);
    }
    return first <= last ? first : std::numeric_limits<float>::infinity();
  }
};

}  // namespace kerf
