// Meshes that stand at several places: what a scene is made of where it is not one mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <kerf/build.hpp>
#include <kerf/bvh.hpp>
#include <kerf/mesh.hpp>
#include <kerf/query.hpp>
#include <kerf/scene.hpp>
#include <kerf/triangle.hpp>
#include <kerf/vec.hpp>

namespace workbench {

struct PlacedMeshes {
  struct Mesh {
    std::vector<kerf::Vec3f> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;

    /// Of a .kerf file, as it was saved; its hits have the places of `triangles` for primitives.
    std::optional<kerf::Bvh> hierarchy = {};

    kerf::TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
  };
  struct Place {
    std::uint32_t mesh;
    kerf::Transform transform = {};  ///< from the mesh to the scene; invertible
  };
  std::vector<Mesh> meshes;
  std::vector<Place> places;

  /// Counted at each place, and once for each mesh.
  std::size_t triangle_count() const;
  std::size_t stored_triangles() const;

  /// A triangle of a mesh, as it stands at a place: its corners moved in double precision and rounded once.
  kerf::Triangle triangle(std::size_t place, std::uint32_t number) const;
};

/// A hierarchy of each mesh, in the order of the meshes: the saved one, or a new one.
std::vector<kerf::Bvh> build_objects(const PlacedMeshes& placed, const kerf::BuildOptions& options = {});

/// The scene of these objects at the places.
kerf::Scene build_scene(const PlacedMeshes& placed, const std::vector<kerf::Bvh>& objects,
                        const kerf::BuildOptions& options = {});

/// What the triangles of all places fill, degenerate ones left out. The scene's own box may be larger: it is
/// put together from boxes that were turned.
kerf::Box3f bounds_of(const PlacedMeshes& placed, const std::vector<kerf::Bvh>& objects);

/// One mesh of all that stands anywhere, or of every n-th triangle so that there are no more than
/// `max_triangles`.
PlacedMeshes::Mesh flattened(const PlacedMeshes& placed, std::size_t max_triangles);

/// A hierarchy of a flattened million of triangles: what rays take in it tells what they take in the scene.
kerf::Bvh build_stand_in(const PlacedMeshes& placed);

}  // namespace workbench
