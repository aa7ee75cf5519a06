// Stanford's .ply files, in text or binary.
#pragma once

#include <filesystem>
#include <string_view>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// The faces in `bytes`, contents of `file`, as triangles; elements and properties that say nothing of them
/// are left out. Vertices may be anything, indices are in range. Throws `kerf::Error` with one line that
/// names the file, the place in it and what is wrong.
Scene read_ply(const std::filesystem::path& file, std::string_view bytes);

}  // namespace workbench
