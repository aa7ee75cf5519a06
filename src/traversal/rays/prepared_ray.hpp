// A ray in the form in which every kernel traces it.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <kerf/ray.hpp>

#include "math/vec3f.hpp"

namespace kerf {

/// A ray with finite t_min and t_max. A very long or very short direction is scaled by a power of two, so
/// that neither distances nor inverses overflow; t is scaled by a power of two as well, and keeps its digits.
struct PreparedRay {
  /// Only a direction whose largest component is not between these is scaled.
  static constexpr float shortest = 0x1p-8f, longest = 0x1p20f;

  Vec3f origin, direction;
  float t_min, t_max;  ///< in lengths of the direction here; both finite
  double scale = 1.0;  ///< a t of this ray is one of the caller's times `scale`

  explicit PreparedRay(const Ray& ray) : origin(ray.origin), direction(ray.direction) {
    const Vec3f& d = ray.direction;
    const float largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    t_min = std::max(ray.t_min, 0.0f);
    t_max = std::min(ray.t_max, std::numeric_limits<float>::max());
    if (!(largest > shortest && largest < longest)) rescale(largest);
    // Zero times an infinity or a NaN is a NaN, which equals nothing.
    const float zero =
        (0.0f * origin.x + 0.0f * origin.y) + (0.0f * origin.z + 0.0f * d.x) + (0.0f * d.y + 0.0f * d.z);
    if (!((zero == 0.0f) & (ray.t_min <= ray.t_max))) t_max = -1.0f;
  }

  /// False for a ray that can hit nothing: t_max < t_min, something not finite, or a direction of zero.
  bool valid() const { return t_min <= t_max; }

  /// The caller's t.
  float unscaled(float t) const { return scale == 1.0 ? t : static_cast<float>(t / scale); }

 private:
  // Makes the largest component one in [1, 2).
  void rescale(double largest) {
    if (!(largest > 0.0)) {
      origin.x = std::numeric_limits<float>::quiet_NaN();
      return;
    }
    constexpr std::uint64_t exponent_bits = 0x7ff0000000000000u;
    const std::uint64_t exponent = std::bit_cast<std::uint64_t>(largest) & exponent_bits;
    scale = std::bit_cast<double>(exponent);
    const double inverse = std::bit_cast<double>(0x7fe0000000000000u - exponent);  // of a power of two: exact
    direction = {static_cast<float>(direction.x * inverse), static_cast<float>(direction.y * inverse),
                 static_cast<float>(direction.z * inverse)};
    t_min = static_cast<float>(t_min * scale);
    t_max = static_cast<float>(std::min<double>(t_max * scale, std::numeric_limits<float>::max()));
  }
};

}  // namespace kerf
