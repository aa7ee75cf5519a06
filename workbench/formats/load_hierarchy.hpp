// The triangles of a .kerf file, with the hierarchy that was saved.
#pragma once

#include <filesystem>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Triangles have the places that they had in the meshes, counted over all of them; where a degenerate one
/// was left out of the hierarchy, one without extent stands in. Throws what `kerf::Bvh::load` does, and
/// `Error::bad_format` for a file without triangles.
Scene load_hierarchy(const std::filesystem::path& file);

}  // namespace workbench
