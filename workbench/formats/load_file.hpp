// Scene files: .obj, .ply, .stl, .gltf and .glb, each also gzipped.
#pragma once

#include <filesystem>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// The triangles of a scene file as one mesh: node transforms applied, polygons triangulated, vertices at the
/// same place joined, points, lines, materials and textures left out. The scene has no name and no viewpoints
/// yet. Throws `kerf::Error` with one line that names the file, the place in it and what is wrong.
Scene load_file(const std::filesystem::path& file);

}  // namespace workbench
