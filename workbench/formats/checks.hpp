// Checks that the importer does not make, or reports in words that do not help (docs/decisions/0001 has what
// it did with damaged files). Each function throws `kerf::Error` with one line that names the file, the place
// in it and what is wrong.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace workbench {

/// Returns the vertices and faces of an .obj file in the simplest syntax, which the importer cannot get
/// wrong.
std::string plain_obj(const std::filesystem::path& file, std::string_view bytes);

/// Returns the triangles of an .stl file, text or binary, as a binary .stl file.
std::string plain_stl(const std::filesystem::path& file, std::string_view bytes);

/// Checks a .gltf file, or the JSON of a .glb file together with its binary chunk. Reads the buffers that the
/// JSON names.
void check_gltf(const std::filesystem::path& file, std::string_view json, std::string_view binary_chunk);

/// Checks a .glb file, in the same way.
void check_glb(const std::filesystem::path& file, std::string_view bytes);

}  // namespace workbench
