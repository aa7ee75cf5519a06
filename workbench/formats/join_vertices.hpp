// Vertices at the same position become one.
#pragma once

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Joins the vertices whose three coordinates have the same bits, in the order of their first use, and drops
/// those that no triangle uses. Importers repeat a vertex for each of its normals and texture coordinates,
/// which a hierarchy does not have.
void join_vertices(Scene& scene);

}  // namespace workbench
