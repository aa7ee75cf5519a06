// The importer of scene files: assimp, of which only the triangles are used.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// The triangles in `bytes`, the unpacked contents of `file`, as one mesh. Indices and vertices are those of
/// the file, valid or not. `format` is the extension that names the format of `bytes`, such as ".obj". Files
/// that `bytes` name (the buffers of a .gltf) are looked for beside `file`. Throws `kerf::Error::bad_format`,
/// or `too_large` for 2^32 vertices or more.
Scene import(const std::filesystem::path& file, std::string_view format, const std::string& bytes);

}  // namespace workbench
