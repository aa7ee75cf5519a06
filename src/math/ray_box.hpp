// Conservative ray-box intersection: no box is missed that holds a point of a triangle which the ray hits.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <kerf/ray.hpp>

#include "math/vec3f.hpp"

namespace kerf {

/// The largest distance along an axis to the far side of the scene.
inline float far_side(const Vec3f& origin, const Box3f& scene) {
  float distance = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    distance = std::max(
        {distance, std::abs(origin[axis] - scene.lower[axis]), std::abs(origin[axis] - scene.upper[axis])});
  }
  return distance;
}

/// A ray as box tests see it: along each axis, the ray enters between two planes at `near * inverse + enter`
/// and leaves at `far * inverse + leave`.
///
/// In effect, boxes are grown by a margin on all sides (as in the appendix of Woop, Benthin & Wald 2013). The
/// two constants contain it, so that it costs nothing per box. It covers every rounding between the exact ray
/// and the computed distances, here and in `intersect_triangle`, in any order, fused or not. (Ize 2013,
/// "Robust BVH Ray Traversal", covers the rounding of the box test alone.) In units of 2^-24, with D the
/// largest distance along an axis from the origin to the scene's far side and O the origin's largest
/// coordinate:
///
///     the shear of a triangle's vertices      6 D     (a difference, a quotient, a product, a difference)
///     inverse, the plane's distance           2 D
///     the triangle's t                       144 D     (24 times the shear, see `CrossingEstimate`)
///     plane times inverse, where not fused    1 D + 1 O
///     origin times inverse, the constants             2 O
///     directions raised to the minimum        1/4 D
///
/// Up to rounding, the triangle's t itself lies in the grown box, so that culling by t is right, too.
struct RayBoxes {
  /// At least the sums of D and of O.
  static constexpr float margin_of_distance = 160.0f, margin_of_origin = 4.0f;

  /// No component of a direction counts as less than this part of the largest, which moves the ray by no more
  /// than a quarter of a unit of D.
  static constexpr float least_part = 0x1p-26f;

  Vec3f inverse, enter, leave;
  float distance = 0.0f;  ///< D

  RayBoxes(const Vec3f& origin, const Vec3f& direction, const Box3f& scene) {
    constexpr float unit = 0x1p-24f;
    const float o[3] = {origin.x, origin.y, origin.z}, d[3] = {direction.x, direction.y, direction.z};
    const float lower[3] = {scene.lower.x, scene.lower.y, scene.lower.z};
    const float upper[3] = {scene.upper.x, scene.upper.y, scene.upper.z};
    float coordinate = 0.0f, largest = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      distance = std::max({distance, std::abs(o[axis] - lower[axis]), std::abs(o[axis] - upper[axis])});
      coordinate = std::max(coordinate, std::abs(o[axis]));
      largest = std::max(largest, std::abs(d[axis]));
    }
    const float margin = unit * (margin_of_distance * distance + margin_of_origin * coordinate);
    const float smallest = least_part * largest;
    float r[3], e[3], l[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float absolute = 1.0f / std::max(std::abs(d[axis]), smallest);
      r[axis] = std::copysign(absolute, d[axis]);
      const float product = o[axis] * r[axis], grown = margin * absolute;
      e[axis] = -product - grown;
      l[axis] = grown - product;
    }
    inverse = {r[0], r[1], r[2]};
    enter = {e[0], e[1], e[2]};
    leave = {l[0], l[1], l[2]};
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
