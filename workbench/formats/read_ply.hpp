// The .ply files of Stanford, text or binary.
#pragma once

#include <filesystem>
#include <string_view>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// The faces in `bytes`, the contents of `file`, as triangles. Other elements and properties are left out.
/// Coordinates may be any floats, indices are in range. Throws `kerf::Error` with one line that names the
/// file, the place in it and what is wrong.
Scene read_ply(const std::filesystem::path& file, std::string_view bytes);

}  // namespace workbench
