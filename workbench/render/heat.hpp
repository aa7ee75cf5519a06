// The heat view: what each pixel's ray cost, as a colour.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <kerf/bvh.hpp>

#include "workbench/render/image.hpp"
#include "workbench/scene/scene.hpp"

namespace workbench {

/// Inner-node visits plus triangle tests of the primary ray through the middle of each pixel.
struct HeatMap {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<float> costs;  ///< row after row from the top left
};

HeatMap trace_heat(const kerf::Bvh& bvh, const Viewpoint& viewpoint, std::size_t width, std::size_t height);

/// Where a scale that serves all of `maps` ends: a round number that all but a few in a thousand pixels stay
/// below.
float common_scale(std::span<const HeatMap> maps);

/// The colour of `fraction` of the scale; beyond 1 it stays as at 1.
Pixel heat_colour(float fraction);

/// `map` in colours from 0 to `scale`.
Image colour(const HeatMap& map, float scale);

}  // namespace workbench
