// Pictures of a scene, traced through the hierarchy under test, so that errors of the hierarchy are visible.
#pragma once

#include <functional>

#include "workbench/render/image.hpp"
#include "workbench/scene/scene.hpp"
#include "workbench/scene/traced.hpp"

namespace workbench {

struct RenderOptions {
  std::size_t width = 1280;
  std::size_t height = 800;
  unsigned samples = 2;          ///< per side: a pixel is the mean of samples x samples camera rays
  unsigned ambient_samples = 6;  ///< ambient-occlusion rays per camera ray

  /// Called repeatedly, never from two threads at once, with the fraction that is done.
  std::function<void(double fraction)> progress = {};
};

/// Clay under a sun and a sky, with shadows, ambient occlusion and haze.
Image render_shaded(const Traced& traced, const Viewpoint& viewpoint, const RenderOptions& options);

/// Ambient occlusion alone: white where nothing is near, dark in corners, before a dull blue.
Image render_ambient_occlusion(const Traced& traced, const Viewpoint& viewpoint,
                               const RenderOptions& options);

}  // namespace workbench
