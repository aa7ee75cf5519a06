// A scene: one triangle mesh, or several that stand at places, and viewpoints of cameras.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <kerf/bvh.hpp>
#include <kerf/mesh.hpp>
#include <kerf/vec.hpp>

#include "workbench/scene/placed.hpp"

namespace workbench {

/// What becomes of meshes that a file shows several times.
enum class Repeats {
  flattened,  ///< copies in one mesh
  kept,       ///< `Scene::placed`
};

struct Viewpoint {
  kerf::Vec3f position;
  kerf::Vec3f target;
  kerf::Vec3f up{0.0f, 1.0f, 0.0f};
  float vertical_field_of_view = 60.0f;  ///< degrees
};

/// What a file holds beside triangles, and what became of it.
struct SceneContents {
  /// One thing: what it is, and how often it is there or what was made of it. "skins", "2, posed by their
  /// joints".
  struct Entry {
    std::string name, value;
  };
  std::vector<Entry> entries;

  /// Triangles that have an area in the file's own numbers, and none when these are rounded to floats.
  std::size_t flattened_triangles = 0;
};

struct Scene {
  std::string name;  ///< as the user wrote it
  std::vector<kerf::Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Viewpoint> viewpoints;    ///< three or more
  bool has_authored_viewpoints = true;  ///< of generated scenes; false: chosen, without knowing what is up
  SceneContents contents = {};          ///< of a file; empty for generated scenes

  /// Of a .kerf file, as it was saved; its hits have the places of `triangles` for primitives.
  std::optional<kerf::Bvh> hierarchy = {};

  /// Of a file that shows a mesh several times, if it was loaded so; `vertices` and `triangles` are empty
  /// then.
  std::optional<PlacedMeshes> placed = {};

  /// Counted at each place.
  std::size_t triangle_count() const { return placed ? placed->triangle_count() : triangles.size(); }

  kerf::TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

}  // namespace workbench
