// Vertices at the same place become one.
#pragma once

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Joins the vertices whose three coordinates have the same bits, in the order of their first use, and drops
/// those that no triangle uses. Importers write a vertex once for each of its normals and texture
/// coordinates, of which a hierarchy knows nothing.
void join_vertices(Scene& scene);

}  // namespace workbench
