// A ray in the form in which every kernel traces it.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <kerf/ray.hpp>

#include "math/ray_crossing.hpp"
#include "math/vec3f.hpp"

namespace kerf {

/// A ray with finite t_min and t_max. A very long or very short direction is scaled by a power of two, so
/// that neither distances nor inverses overflow; t is scaled by a power of two as well, and keeps its digits.
struct PreparedRay {
  /// Only a direction whose largest component is not between these is scaled.
  static constexpr float shortest = 0x1p-8f, longest = 0x1p20f;

  /// Where the distance to the far side of the scene and its largest coordinate add up to this, every
  /// direction is scaled, and to another length: box tests divide coordinates by the direction's components,
  /// of which none counts as less than 2^-26 of the largest, and the quotients must not overflow.
  static constexpr float far = 0x1p90f;
  static constexpr double length_when_far = 0x1p26;

  Vec3f origin, direction;
  float t_min, t_max;  ///< in lengths of the direction here; both finite
  double scale = 1.0;  ///< a t of this ray is one of the caller's times `scale`

  /// `is_far` says that the scene is.
  explicit PreparedRay(const Ray& ray, bool is_far = false) : origin(ray.origin), direction(ray.direction) {
    const Vec3f& d = ray.direction;
    const float largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    t_min = std::max(ray.t_min, -largest_t);
    t_max = std::min(ray.t_max, largest_t);
    if (is_far || !(largest > shortest && largest < longest))
      rescale(largest, is_far ? length_when_far : 1.0);
    // Zero times an infinity or a NaN is a NaN, which equals nothing.
    const float zero =
        (0.0f * origin.x + 0.0f * origin.y) + (0.0f * origin.z + 0.0f * d.x) + (0.0f * d.y + 0.0f * d.z);
    if (!((zero == 0.0f) & (ray.t_min <= ray.t_max))) t_max = -std::numeric_limits<float>::infinity();
  }

  /// False for a ray that can hit nothing: t_max < t_min, something not finite, or a direction of zero.
  bool valid() const { return t_min <= t_max; }

  /// The caller's t, not 0 where that of this ray is not.
  float unscaled(float t) const { return scale == 1.0 ? t : round_distance(t / scale); }

  /// Whether an end of the caller's range, `ray`'s, may be one to which several t of this ray are rounded.
  bool has_subnormal_end(const Ray& ray) const {
    return scale != 1.0 && ((ray.t_min != 0.0f && std::abs(ray.t_min) < smallest_exact) ||
                            std::abs(ray.t_max) < smallest_exact);
  }

 private:
  static constexpr float largest_t = std::numeric_limits<float>::max();

  // Subnormal floats are 2^-149 apart: what rounds to one lies half of that away at most. To a float that is
  // not smaller than this, adding the half makes no difference.
  static constexpr double half_step = 0x1p-150;
  static constexpr float smallest_exact = 0x1p-125f;

  float scaled(double t) const {
    return static_cast<float>(std::clamp(t * scale, double{-largest_t}, double{largest_t}));
  }

  // Makes the largest component one in [length, 2 length), where `length` is a power of two.
  void rescale(double largest, double length) {
    if (!(largest > 0.0)) {
      origin.x = std::numeric_limits<float>::quiet_NaN();
      return;
    }
    constexpr std::uint64_t exponent_bits = 0x7ff0000000000000u;
    const std::uint64_t exponent = std::bit_cast<std::uint64_t>(largest) & exponent_bits;
    scale = std::bit_cast<double>(exponent) / length;
    // Of a power of two: exact.
    const double inverse = std::bit_cast<double>(0x7fe0000000000000u - exponent) * length;
    direction = {static_cast<float>(direction.x * inverse), static_cast<float>(direction.y * inverse),
                 static_cast<float>(direction.z * inverse)};
    // A t of 0 is no rounded one: `unscaled` keeps signs.
    t_min = scaled(t_min == 0.0f ? 0.0 : t_min - half_step);
    t_max = scaled(t_max + half_step);
  }
};

}  // namespace kerf
