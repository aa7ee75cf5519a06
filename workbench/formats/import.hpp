// The importer of scene files: assimp, and nothing of it beyond the triangles.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// The triangles in `bytes`, unpacked contents of `file`, as one mesh; indices and vertices are as the file
/// has them, good or bad. `format` is the extension that says what they are: ".obj". Files that the contents
/// name (the buffers of a .gltf) are looked for beside `file`. Throws `kerf::Error::bad_format`.
Scene import(const std::filesystem::path& file, std::string_view format, const std::string& bytes);

}  // namespace workbench
