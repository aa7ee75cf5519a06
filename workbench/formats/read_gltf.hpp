// The .gltf and .glb files of Khronos: glTF 2.0.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/read_mesh.hpp"
#include "workbench/scene/placed.hpp"

namespace workbench {

/// Instances may make many triangles of few; a hierarchy holds no more than these.
inline constexpr std::uint64_t max_gltf_triangles = std::uint64_t{1} << 28;

/// The triangles that the scene in `bytes`, the contents of `file`, shows: as its nodes move them, its skins
/// and morph targets pose them, and with all instances. Files that it names are looked for beside it. Throws
/// `kerf::Error` with one line that names the file, the place in its JSON and what is wrong.
ReadMesh read_gltf(const std::filesystem::path& file, const FileBytes& bytes,
                   std::uint64_t max_triangles = max_gltf_triangles);

/// What the scene of a glTF file shows, each mesh once.
struct GltfMeshes {
  /// Those that the scene shows several times, and first, if there is any, one of all that it shows once.
  std::vector<ReadMesh> meshes;
  /// Of all of them; none if nothing is shown several times: there is one mesh then.
  std::vector<PlacedMeshes::Place> places;
  SceneContents contents;
};

/// As `read_gltf`, without copies of what is shown several times. Meshes that skins pose, and those that are
/// flattened where they are shown, are copied nevertheless.
GltfMeshes read_gltf_meshes(const std::filesystem::path& file, const FileBytes& bytes,
                            std::uint64_t max_triangles = max_gltf_triangles);

}  // namespace workbench
