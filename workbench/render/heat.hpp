// The heat view: the cost of each pixel's ray as a colour.
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

/// Traces the primary rays of `viewpoint`: one for each square of `block` by `block` pixels.
HeatMap trace_heat(const kerf::Bvh& bvh, const Viewpoint& viewpoint, std::size_t width, std::size_t height,
                   std::size_t block = 1);

/// The end of a scale for all of `maps`: a round number that all but a few pixels per thousand stay below.
float common_scale(std::span<const HeatMap> maps);

/// The colour at `fraction` of the scale; beyond 1 that of 1.
Pixel heat_colour(float fraction);

/// `map` in the colours of a scale from 0 to `scale`.
Image colour(const HeatMap& map, float scale);

/// Draws the scale into the lower left corner: its colours, and numbers at its quarters. Leaves pictures as
/// they are that are too small for it.
void draw_legend(Image& image, float scale);

}  // namespace workbench
