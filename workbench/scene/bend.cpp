#include "workbench/scene/bend.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <kerf/mesh.hpp>

namespace workbench {

void bend(std::span<const kerf::Vec3f> rest, double amount, double phase, std::span<kerf::Vec3f> bent) {
  kerf::Box3f box;
  for (const kerf::Vec3f& v : rest) {
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::min(box.lower[axis], v[axis]);
      box.upper[axis] = std::max(box.upper[axis], v[axis]);
    }
  }
  int along = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (box.upper[axis] - box.lower[axis] > box.upper[along] - box.lower[along]) along = axis;
  const double extent = static_cast<double>(box.upper[along]) - box.lower[along];
  for (std::size_t i = 0; i < bent.size(); ++i) {
    const kerf::Vec3f& v = rest[i];
    const double part = extent > 0.0 ? (v[along] - box.lower[along]) / extent : 0.0;
    const double angle = 2.0 * std::numbers::pi * part + phase;
    bent[i] = v;
    bent[i][(along + 1) % 3] += static_cast<float>(amount * extent * std::sin(angle));
    bent[i][(along + 2) % 3] += static_cast<float>(0.5 * amount * extent * std::cos(angle));
  }
}

}  // namespace workbench
