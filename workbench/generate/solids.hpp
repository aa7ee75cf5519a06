// Closed surfaces for tests. Exactly two triangles share each edge, and all face outward.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <kerf/mesh.hpp>
#include <kerf/vec.hpp>

namespace workbench {

/// A closed triangle mesh that owns its memory. Counter-clockwise seen from outside.
struct Solid {
  std::vector<kerf::Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  kerf::TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

/// A sphere: the icosahedron subdivided `level` times, with its vertices moved to distance `radius`. It has
/// 20 * 4^level triangles: 20, 80, 320, 1,280, 5,120, 20,480, and 81,920 at level 6. Range of `level`: [0,
/// 10].
Solid make_sphere(int level, float radius = 1.0f, kerf::Vec3f center = {});

/// A torus round the y axis: `major` segments along the ring of radius `ring_radius`, `minor` round its tube
/// of radius `tube_radius`; 2 * major * minor triangles. Both at least 3.
Solid make_torus(std::uint32_t major, std::uint32_t minor, float ring_radius = 1.0f,
                 float tube_radius = 0.4f);

/// The axis-aligned box between two corners, each face divided into `divisions` by `divisions` squares;
/// 12 * divisions^2 triangles, vertices shared across the edges of the box.
Solid make_box(kerf::Vec3f lower, kerf::Vec3f upper, std::uint32_t divisions = 1);

}  // namespace workbench
