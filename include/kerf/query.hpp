// What the spatial queries of a `Bvh` answer with.
#pragma once

#include <cstdint>

#include <kerf/ray.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// A triangle by its place in the caller's meshes.
struct PrimitiveId {
  std::uint32_t primitive = invalid_id;  ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;       ///< number of the mesh in the order given to `build`

  friend constexpr bool operator==(const PrimitiveId&, const PrimitiveId&) = default;
};

/// The point of a triangle that is closest to a given point: `(1 - u - v) * v0 + u * v1 + v * v2`, rounded.
struct SurfacePoint {
  Vec3f position;                        ///< the point itself
  float distance = 0.0f;                 ///< from the given point
  float u = 0.0f;                        ///< weight of v1
  float v = 0.0f;                        ///< weight of v2
  std::uint32_t primitive = invalid_id;  ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;       ///< number of the mesh in the order given to `build`

  friend constexpr bool operator==(const SurfacePoint&, const SurfacePoint&) = default;
};

}  // namespace kerf
