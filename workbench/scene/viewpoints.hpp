// Viewpoints for a scene of which nothing but the triangles is known.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <kerf/mesh.hpp>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Three viewpoints inside the bounds, in open places with a long view, then three outside from which all of
/// the mesh is visible. The y axis is up. The result depends on the mesh alone. The mesh must be valid.
std::vector<Viewpoint> choose_viewpoints(const kerf::TriangleMesh& mesh);

/// The same of a scene of either kind.
std::vector<Viewpoint> choose_viewpoints(const Scene& scene);

/// Where to look from, by name, all outside: the directions of technical drawings with `up` upwards.
inline constexpr std::string_view view_names[] = {"front", "back", "left", "right", "top", "bottom", "iso"};

/// The view of that name, from as near as possible for a picture of `aspect` (its width over its height) to
/// show all of the mesh; nothing if there is no such name. With y up, `front` looks along -z; with z up,
/// along y. The mesh must be valid.
std::optional<Viewpoint> named_view(const kerf::TriangleMesh& mesh, std::string_view name,
                                    const kerf::Vec3f& up, float aspect);

/// The same of a scene of either kind.
std::optional<Viewpoint> named_view(const Scene& scene, std::string_view name, const kerf::Vec3f& up,
                                    float aspect);

}  // namespace workbench
