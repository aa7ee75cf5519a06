// What the importer does not check, or not in words that help. Measured with assimp 5.2.5: of twenty damaged
// .ply files three crash it, two hang it and four are read in part without a word; .obj and .gltf errors name
// no place.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace workbench {

/// Each of these throws `kerf::Error` with one line that names the file, the place in it and what is wrong.

/// Returns what makes triangles in an .obj file, written in the plainest way: of valid numbers that begin
/// with a point, lines that `\` continues, and normals, texture coordinates and materials, assimp 5.2.5
/// misreads some.
std::string plain_obj(const std::filesystem::path& file, std::string_view bytes);

void check_ply(const std::filesystem::path& file, std::string_view bytes);
void check_stl(const std::filesystem::path& file, std::string_view bytes);

/// A .gltf file, or the JSON of a .glb file with what stands in its binary chunk. Reads the buffers that it
/// names.
void check_gltf(const std::filesystem::path& file, std::string_view json, std::string_view binary_chunk);
void check_glb(const std::filesystem::path& file, std::string_view bytes);

}  // namespace workbench
