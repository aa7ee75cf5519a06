// What is checked of every mesh that was read, whatever its format.
#pragma once

#include <array>
#include <filesystem>

#include <kerf/vec.hpp>

#include "workbench/formats/read_mesh.hpp"

namespace workbench {

/// Throws unless there are triangles, and all vertices that they use are finite. Drops the vertices that none
/// uses. Counts the triangles that rounding has flattened.
void check_mesh(const std::filesystem::path& file, ReadMesh& mesh);

/// True if a triangle has no area, and had one before `remainders` were taken from its corners.
bool is_flattened(const std::array<kerf::Vec3f, 3>& corners, const std::array<kerf::Vec3f, 3>& remainders);

}  // namespace workbench
