// The .obj files of Wavefront.
#pragma once

#include <filesystem>

#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/read_mesh.hpp"

namespace workbench {

/// The faces in `bytes`, the contents of `file`, as triangles; everything but `v` and `f` is passed over.
/// Throws `kerf::Error` with one line that names the file, the line in it and what is wrong.
ReadMesh read_obj(const std::filesystem::path& file, const FileBytes& bytes);

}  // namespace workbench
