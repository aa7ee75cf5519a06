// The .gltf and .glb files of Khronos: glTF 2.0.
#pragma once

#include <cstdint>
#include <filesystem>

#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/read_mesh.hpp"

namespace workbench {

/// Instances may make many triangles of few; a hierarchy holds no more than these.
inline constexpr std::uint64_t max_gltf_triangles = std::uint64_t{1} << 28;

/// The triangles that the scene in `bytes`, the contents of `file`, shows: as its nodes move them, its skins
/// and morph targets pose them, and with all instances. Files that it names are looked for beside it. Throws
/// `kerf::Error` with one line that names the file, the place in its JSON and what is wrong.
ReadMesh read_gltf(const std::filesystem::path& file, const FileBytes& bytes,
                   std::uint64_t max_triangles = max_gltf_triangles);

}  // namespace workbench
