// Viewpoints for a scene of which nothing but the triangles is known.
#pragma once

#include <vector>

#include <kerf/mesh.hpp>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Three viewpoints inside the bounds, in open places with a long view, then three outside from which all of
/// the mesh is visible. The y axis is up. The result depends on the mesh alone. The mesh must be valid.
std::vector<Viewpoint> choose_viewpoints(const kerf::TriangleMesh& mesh);

}  // namespace workbench
