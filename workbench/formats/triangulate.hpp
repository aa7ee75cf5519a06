// Polygons into triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Polygons of more corners than this become fans. The time to find ears grows with the square of the number
/// of corners or worse: 100,000 corners take half a minute.
inline constexpr std::size_t max_corners_with_ears = 1000;

/// Appends the triangles of a polygon, which has three vertices or more, indices into `scene.vertices`. There
/// are two triangles fewer than vertices. A concave polygon that is about flat is triangulated by cutting off
/// ears; one that crosses itself becomes a fan.
void append_polygon(Scene& scene, std::span<const std::uint32_t> polygon);

}  // namespace workbench
