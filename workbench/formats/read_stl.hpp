// .stl files, text or binary.
#pragma once

#include <filesystem>

#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/read_mesh.hpp"

namespace workbench {

/// The facets in `bytes`, the contents of `file`, as triangles; their vertices are joined where all three
/// coordinates have the same bits. Normals, names and colours are passed over. Throws `kerf::Error` with one
/// line that names the file, the place in it and what is wrong.
ReadMesh read_stl(const std::filesystem::path& file, const FileBytes& bytes);

}  // namespace workbench
