// Pictures of a scene, traced through the hierarchy under test, so that errors of the hierarchy are visible.
#pragma once

#include <functional>
#include <string>

#include <kerf/bvh.hpp>

#include "workbench/render/image.hpp"
#include "workbench/scene/scene.hpp"
#include "workbench/scene/traced.hpp"

namespace workbench {

struct RenderOptions {
  std::size_t width = 1280;
  std::size_t height = 800;
  unsigned samples = 2;          ///< per side: a pixel is the mean of samples x samples camera rays
  unsigned ambient_samples = 6;  ///< ambient-occlusion rays per camera ray
  std::size_t block = 1;         ///< pixels per side of the squares that are seen as one

  /// Called repeatedly, never from two threads at once, with the fraction that is done.
  std::function<void(double fraction)> progress = {};
};

/// Visits of nodes and tests of triangles that the camera rays of a pixel may take. In sticks, the dearest of
/// the generated scenes, nine rays take 2,900.
inline constexpr double max_visits_of_a_pixel = 8192.0;

/// `options`, or fewer rays of the picture if so much lies over one another that camera rays would take more
/// than `max_visits` for a pixel: first fewer samples, then larger blocks. `bvh` is one of the scene. The
/// same on every run, since it counts and does not time.
RenderOptions affordable(const kerf::Bvh& bvh, const Viewpoint& viewpoint, const RenderOptions& options,
                         double max_visits = max_visits_of_a_pixel);

/// Says how `given` is coarser than `asked`; empty if it is not.
std::string remark_on(const RenderOptions& given, const RenderOptions& asked);

/// Clay under a sun and a sky, with shadows, ambient occlusion and haze.
Image render_shaded(const Traced& traced, const Viewpoint& viewpoint, const RenderOptions& options);

/// Ambient occlusion alone: white where nothing is near, dark in corners, before a dull blue.
Image render_ambient_occlusion(const Traced& traced, const Viewpoint& viewpoint,
                               const RenderOptions& options);

}  // namespace workbench
