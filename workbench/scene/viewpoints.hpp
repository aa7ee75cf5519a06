// Where to look at a scene from of which nothing is known but its triangles.
#pragma once

#include <vector>

#include <kerf/mesh.hpp>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Three viewpoints inside the bounds, in open places looking far, then three outside from which all of the
/// mesh is seen. The y axis is up. The same for the same mesh, on every run. The mesh must be valid.
std::vector<Viewpoint> choose_viewpoints(const kerf::TriangleMesh& mesh);

}  // namespace workbench
