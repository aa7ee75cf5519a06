// Scene files: .obj, .ply, .stl, .gltf and .glb, each also gzipped, and .kerf.
#pragma once

#include <filesystem>
#include <string_view>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// The triangles of a scene file as one mesh, or as several at their places where `repeats` keeps them and
/// the file shows one more than once. Node transforms are applied, polygons triangulated and vertices at the
/// same position joined; points, lines, materials and textures are left out. The scene has no name and no
/// viewpoints yet. `format` is one of `obj ply stl gltf glb kerf`; if it is empty, the file's ending says it.
/// Throws `kerf::Error` with one line that names the file, the place in it and what is wrong.
Scene load_file(const std::filesystem::path& file, std::string_view format = {},
                Repeats repeats = Repeats::flattened);

}  // namespace workbench
