// Rays and what they hit.
#pragma once

#include <cstdint>
#include <limits>

#include <kerf/vec.hpp>

namespace kerf {

/// The points `origin + t * direction` with `t_min <= t <= t_max`.
///
/// `direction` need not have unit length (t counts in its lengths) and may have zero components, but not
/// three. `t_min` is at least 0; a ray with `t_max < t_min`, or with a component that is not a number, hits
/// nothing.
struct Ray {
  Vec3f origin;
  Vec3f direction;
  float t_min = 0.0f;
  float t_max = std::numeric_limits<float>::infinity();
};

/// Stands for no triangle.
inline constexpr std::uint32_t invalid_id = 0xffffffffu;

/// Where a ray crosses a triangle with vertices v0, v1, v2: at `(1 - u - v) * v0 + u * v1 + v * v2`.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0.0f;
  float v = 0.0f;
  std::uint32_t primitive = invalid_id;  ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;       ///< number of the mesh in the order given to `build`

  /// True for a hit, false for the value that the span calls write for a miss.
  constexpr explicit operator bool() const { return primitive != invalid_id; }

  friend constexpr bool operator==(const Hit&, const Hit&) = default;
};

}  // namespace kerf
