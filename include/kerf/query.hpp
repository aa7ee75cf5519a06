// What the spatial queries of a `Bvh` answer with.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <cstddef>
#include <cstdint>
#include <limits>

#include <kerf/ray.hpp>
#include <kerf/triangle.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// A triangle by its place in the caller's meshes.
struct PrimitiveId {
  std::uint32_t primitive = invalid_id;  ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;       ///< number of the mesh in the order given to `build`

  friend constexpr bool operator==(const PrimitiveId&, const PrimitiveId&) = default;
};

/// Where a point lies with regard to a closed surface.
enum class Side : std::uint8_t {
  outside,  ///< not inside and not on the surface
  on,       ///< on a triangle
  inside,   ///< an odd number of crossings away from outside
};

/// The point of a triangle that is closest to a given point: `(1 - u - v) * v0 + u * v1 + v * v2`, rounded.
struct SurfacePoint {
  Vec3f position;                                           ///< the point itself
  float distance = std::numeric_limits<float>::infinity();  ///< from the given point
  float u = 0.0f;                                           ///< weight of v1
  float v = 0.0f;                                           ///< weight of v2
  std::uint32_t primitive = invalid_id;                     ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;  ///< number of the mesh in the order given to `build`

  /// True for a point, false for the value that calls for many points write where there is none.
  constexpr explicit operator bool() const { return primitive != invalid_id; }

  friend constexpr bool operator==(const SurfacePoint&, const SurfacePoint&) = default;
};

/// What a ray meets at a hit.
struct HitGeometry {
  Triangle triangle;  ///< the triangle hit, by its corners
  Vec3f normal;       ///< of unit length, to the side from which v0, v1, v2 run counter-clockwise
  bool front = true;  ///< whether the ray comes from that side; a ray in the triangle's plane does
};

/// What a hierarchy has of one of its meshes.
struct MeshStatistics {
  std::size_t triangles = 0;   ///< in the mesh given
  std::size_t left_out = 0;    ///< of these, in no leaf: those that have no area
  std::size_t references = 0;  ///< triangles in leaves, each counted once per leaf
  Box3f bounds;                ///< around the triangles in leaves
};

/// Two triangles that have a point in common, one of each of two hierarchies.
struct TouchingPair {
  PrimitiveId first;   ///< of the hierarchy that was asked
  PrimitiveId second;  ///< of the other

  friend constexpr bool operator==(const TouchingPair&, const TouchingPair&) = default;
};

/// An affine map: (x, y, z) becomes `rows[i][0] * x + rows[i][1] * y + rows[i][2] * z + rows[i][3]` for i =
/// 0, 1 and 2. By default, the map that changes nothing.
struct Transform {
  double rows[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};  ///< row by row, the translation last
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
