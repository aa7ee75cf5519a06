// Rays and what they hit.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <cstdint>
#include <limits>

#include <kerf/vec.hpp>

namespace kerf {

/// The points `origin + t * direction` with `t_min <= t <= t_max`.
///
/// Coordinates of the origin are below 2^126. `direction` need not have unit length (t counts in its lengths)
/// and may have zero components, but not three. A ray may begin behind its origin: `t_min` and `t_max` may be
/// negative, and infinite ones of both signs make it a line. A ray with `t_max < t_min`, or with a component
/// that is not a number, hits nothing.
struct Ray {
  Vec3f origin;        ///< the point at t = 0
  Vec3f direction;     ///< of any length but 0
  float t_min = 0.0f;  ///< hits with a smaller t do not count
  /// Hits with a larger t do not count.
  float t_max = std::numeric_limits<float>::infinity();
};

/// A ray in double precision, in the coordinates of a `DoubleMesh`; `Bvh::to_local` makes the ray that is
/// traced.
struct DoubleRay {
  Vec3d origin;        ///< the point at t = 0
  Vec3d direction;     ///< of any length but 0
  double t_min = 0.0;  ///< hits with a smaller t do not count
  /// Hits with a larger t do not count.
  double t_max = std::numeric_limits<double>::infinity();
};

/// Which meshes a ray sees: those whose `TriangleMesh::mask` has a bit in common with this.
struct Mask {
  std::uint32_t bits = 0xffffffffu;  ///< 0: none, not even those with all bits

  friend constexpr bool operator==(const Mask&, const Mask&) = default;
};

/// Stands for no triangle.
inline constexpr std::uint32_t invalid_id = 0xffffffffu;

/// Where a ray crosses a triangle with vertices v0, v1, v2: at `(1 - u - v) * v0 + u * v1 + v * v2`.
struct Hit {
  float t = std::numeric_limits<float>::infinity();  ///< in lengths of the direction
  float u = 0.0f;                                    ///< weight of v1
  float v = 0.0f;                                    ///< weight of v2
  std::uint32_t primitive = invalid_id;              ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;                   ///< number of the mesh in the order given to `build`

  /// True for a hit, false for the value that the span calls write for a miss.
  constexpr explicit operator bool() const { return primitive != invalid_id; }

  friend constexpr bool operator==(const Hit&, const Hit&) = default;
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
