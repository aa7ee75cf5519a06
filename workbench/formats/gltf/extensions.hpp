// Extensions of glTF: which of them a reader of triangles understands.
#pragma once

#include <string_view>

namespace workbench::gltf {

/// True if a file that requires the extension is read right: it is about triangles and understood, or about
/// something that triangles do not depend on.
bool is_understood(std::string_view extension);

}  // namespace workbench::gltf
