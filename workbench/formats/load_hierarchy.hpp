// The triangles of a .kerf file, with the hierarchy that was saved.
#pragma once

#include <filesystem>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Triangles have the places that they had in the meshes, counted over all of them; where a degenerate one
/// was left out of the hierarchy, one without extent stands in. Throws what `kerf::Bvh::load` does, and
/// `Error::bad_format` for a file without triangles. The instances of all levels of a scene in a file are
/// kept as one level of places, or flattened.
Scene load_hierarchy(const std::filesystem::path& file, Repeats repeats = Repeats::flattened);

}  // namespace workbench
