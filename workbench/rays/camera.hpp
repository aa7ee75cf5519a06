// From pixels to rays.
#pragma once

#include <cstddef>

#include <kerf/ray.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/scene/scene.hpp"

namespace workbench {

/// A pinhole camera at a viewpoint. Pixel (0, 0) is the upper left one, its centre at (0.5, 0.5).
class Camera {
 public:
  Camera(const Viewpoint& viewpoint, std::size_t width, std::size_t height);

  /// The ray through the point (x, y) of the picture, in pixels. Its direction has about unit length.
  kerf::Ray ray_through(float x, float y) const;

  kerf::Vec3f position() const { return position_; }

  /// From the camera to the point (x, y) of the picture, which lies at distance 1.
  kerf::Vec3f way_to(float x, float y) const { return corner_ + x * step_x_ + y * step_y_; }

 private:
  kerf::Vec3f position_, corner_, step_x_, step_y_;
};

}  // namespace workbench
