// Directions that favour none.
#pragma once

#include <cmath>

#include <kerf/vec.hpp>

#include "workbench/sampling/angles.hpp"
#include "workbench/sampling/random.hpp"

namespace workbench {

/// Uniform on the unit sphere: a slice between two parallel planes has an area proportional to their
/// distance.
inline kerf::Vec3f random_direction(RandomNumbers& random) {
  const float y = random.between(-1.0f, 1.0f), r = std::sqrt(1.0f - y * y);
  const auto [sine, cosine] = sine_cosine(random.uniform());
  return {r * cosine, y, r * sine};
}

}  // namespace workbench
