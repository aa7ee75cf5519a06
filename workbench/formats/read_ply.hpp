// The .ply files of Stanford, text or binary.
#pragma once

#include <filesystem>

#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/read_mesh.hpp"

namespace workbench {

/// The faces and strips in `bytes`, the contents of `file`, as triangles. Other elements and properties are
/// passed over. Throws `kerf::Error` with one line that names the file, the place in it and what is wrong.
ReadMesh read_ply(const std::filesystem::path& file, const FileBytes& bytes);

}  // namespace workbench
