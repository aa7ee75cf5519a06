#include "workbench/rays/camera.hpp"

#include "workbench/base/vectors.hpp"
#include "workbench/sampling/angles.hpp"

namespace workbench {

Camera::Camera(const Viewpoint& viewpoint, std::size_t width, std::size_t height)
    : position_(viewpoint.position) {
  const Vec3f forward = normalize(viewpoint.target - viewpoint.position);
  const Vec3f right = normalize(cross(forward, viewpoint.up));
  const Vec3f up = cross(right, forward);
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  const auto [sine, cosine] = sine_cosine(0.5 * viewpoint.vertical_field_of_view / 360.0);
  const float pixel = 2.0f * (sine / cosine) / h;
  step_x_ = pixel * right;
  step_y_ = -pixel * up;
  corner_ = forward - 0.5f * w * step_x_ - 0.5f * h * step_y_;
}

kerf::Ray Camera::ray_through(float x, float y) const {
  return {.origin = position_, .direction = normalize(way_to(x, y))};
}

}  // namespace workbench
