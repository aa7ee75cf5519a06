// What the importer does not check, or not in words that help (docs/decisions/0001 has what it did with
// damaged files). Each of these throws `kerf::Error` with one line that names the file, the place in it and
// what is wrong.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace workbench {

/// Returns what makes triangles in an .obj file, written in the plainest way, so that nothing else can go
/// wrong.
std::string plain_obj(const std::filesystem::path& file, std::string_view bytes);

/// Returns an .stl file as a binary one.
std::string plain_stl(const std::filesystem::path& file, std::string_view bytes);

/// A .gltf file, or the JSON of a .glb file with what stands in its binary chunk. Reads the buffers that it
/// names.
void check_gltf(const std::filesystem::path& file, std::string_view json, std::string_view binary_chunk);
void check_glb(const std::filesystem::path& file, std::string_view bytes);

}  // namespace workbench
