// Polygons into triangles.
#pragma once

#include <cstdint>
#include <span>

#include "workbench/scene.hpp"

namespace workbench {

/// Appends the triangles of a polygon of three vertices or more, numbers in `scene.vertices`: two fewer than
/// it has vertices. Concave ones too, if they are about flat, by cutting off ears; what crosses itself
/// becomes a fan.
void append_polygon(Scene& scene, std::span<const std::uint32_t> polygon);

}  // namespace workbench
