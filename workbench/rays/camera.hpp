// From pixels to rays.
#pragma once

#include <cstddef>

#include <kerf/ray.hpp>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// A pinhole camera at a viewpoint. Pixel (0, 0) is the upper left one, its centre at (0.5, 0.5).
class Camera {
 public:
  Camera(const Viewpoint& viewpoint, std::size_t width, std::size_t height);

  /// The ray through the point (x, y) of the picture, in pixels. Its direction has about unit length.
  kerf::Ray ray_through(float x, float y) const;

 private:
  kerf::Vec3f position_, corner_, step_x_, step_y_;  // the picture lies at distance 1
};

}  // namespace workbench
