// From what a user writes to a scene.
#pragma once

#include <string_view>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Loads or generates what `spec` names: a file or a generated scene, then optionally `:key=value,...`
/// (`rotate=30` turns it 30 degrees about z, then y, then x; `detail=2` doubles the number of triangles of a
/// generated scene). `format` (`obj`, ...) says what a file is, whatever its name; empty: its ending does.
/// `-` is standard input. Throws `kerf::Error` with one line that names the file, the place in it and what is
/// wrong. `repeats` says what becomes of meshes that a file shows several times.
Scene load_scene(std::string_view spec, std::string_view format = {}, Repeats repeats = Repeats::flattened);

}  // namespace workbench
