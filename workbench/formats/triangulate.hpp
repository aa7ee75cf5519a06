// Polygons into triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Finding ears takes time with the square of the number of corners or worse: 100,000 of them, half a minute.
/// Polygons of more than this become fans.
inline constexpr std::size_t most_corners_with_ears = 1000;

/// Appends the triangles of a polygon of three vertices or more, numbers in `scene.vertices`: two fewer than
/// it has vertices. Concave ones too, if they are about flat, by cutting off ears; what crosses itself
/// becomes a fan.
void append_polygon(Scene& scene, std::span<const std::uint32_t> polygon);

}  // namespace workbench
