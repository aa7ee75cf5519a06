// Uniformly distributed directions.
#pragma once

#include <cmath>

#include <kerf/vec.hpp>

#include "workbench/sampling/angles.hpp"
#include "workbench/sampling/random.hpp"

namespace workbench {

/// A direction that is uniformly distributed on the unit sphere: the area of the sphere between two parallel
/// planes is proportional to their distance (Archimedes), so that its height is uniformly distributed.
inline kerf::Vec3f random_direction(RandomNumbers& random) {
  const float y = random.between(-1.0f, 1.0f), r = std::sqrt(1.0f - y * y);
  const auto [sine, cosine] = sine_cosine(random.uniform());
  return {r * cosine, y, r * sine};
}

}  // namespace workbench
