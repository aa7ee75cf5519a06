// From pixels to rays.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

#include <kerf/ray.hpp>

#include "math/vec3f.hpp"
#include "workbench/scene/scene.hpp"

namespace workbench {

/// A pinhole camera at a viewpoint. Pixel (0, 0) is the upper left one, its centre at (0.5, 0.5).
class Camera {
 public:
  Camera(const Viewpoint& viewpoint, std::size_t width, std::size_t height) : position_(viewpoint.position) {
    using namespace kerf;
    const Vec3f forward = normalize(viewpoint.target - viewpoint.position);
    const Vec3f right = normalize(cross(forward, viewpoint.up));
    const Vec3f up = cross(right, forward);
    const auto w = static_cast<float>(width), h = static_cast<float>(height);
    const float radians = viewpoint.vertical_field_of_view * std::numbers::pi_v<float> / 180.0f;
    const float pixel = 2.0f * std::tan(0.5f * radians) / h;  // the image lies at distance 1
    per_x_ = pixel * right;
    per_y_ = -pixel * up;
    corner_ = forward - 0.5f * w * per_x_ - 0.5f * h * per_y_;
  }

  /// The direction has about unit length.
  kerf::Ray ray_through(float x, float y) const {
    return {.origin = position_, .direction = normalize(corner_ + x * per_x_ + y * per_y_)};
  }

 private:
  using Vec3f = kerf::Vec3f;
  Vec3f position_, corner_, per_x_, per_y_;
};

}  // namespace workbench
