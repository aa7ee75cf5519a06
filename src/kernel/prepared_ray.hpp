// A ray brought into the form in which every kernel traces it.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <kerf/ray.hpp>
#include <limits>

#include "math/vec3f.hpp"

namespace kerf {

/// The ray with its direction scaled by a power of two so that its largest component is in [1, 2): then
/// neither distances nor inverses overflow, and t, being scaled by a power of two as well, has the same
/// digits.
struct PreparedRay {
  Vec3f origin, direction;
  float t_min, t_max;  ///< in lengths of the scaled direction, and finite
  double scale;        ///< a t of this ray is one of the caller's times `scale`

  explicit PreparedRay(const Ray& ray) : origin(ray.origin) {
    const Vec3f& d = ray.direction;
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    constexpr std::uint64_t exponent_bits = 0x7ff0000000000000u;
    const std::uint64_t exponent = std::bit_cast<std::uint64_t>(largest) & exponent_bits;
    scale = std::bit_cast<double>(exponent);
    const double inverse = std::bit_cast<double>(0x7fe0000000000000u - exponent);  // of a power of two: exact
    direction = {static_cast<float>(d.x * inverse), static_cast<float>(d.y * inverse),
                 static_cast<float>(d.z * inverse)};
    t_min = static_cast<float>(std::max(ray.t_min, 0.0f) * scale);
    t_max = static_cast<float>(std::min<double>(ray.t_max * scale, std::numeric_limits<float>::max()));
    // Zero times anything infinite or not a number is not a number, which equals nothing.
    const bool finite =
        0.0f * origin.x + 0.0f * origin.y + 0.0f * origin.z + 0.0f * d.x + 0.0f * d.y + 0.0f * d.z == 0;
    if (!(finite && largest > 0.0 && ray.t_min <= ray.t_max)) t_max = -1.0f;
  }

  /// False for a ray that can hit nothing: t_max < t_min, something not finite, or a direction of zero.
  bool valid() const { return t_min <= t_max; }

  /// The caller's t.
  float unscaled(float t) const { return static_cast<float>(t / scale); }
};

}  // namespace kerf
