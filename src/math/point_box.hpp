// A lower bound of the distance from a point to a box.
#pragma once

#include <algorithm>

#include "math/box3f.hpp"

namespace kerf {

/// The squared distance to the nearest point of the box, rounded down by a few units in the last place.
inline double squared_distance(const Vec3f& p, const Box3f& box) {
  // The rounding of differences, squares and sums is below 7 * 2^-53; twice that is taken off.
  constexpr double below = 1.0 - 16.0 / 9007199254740992.0;
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = std::max({0.0, static_cast<double>(box.lower[axis]) - p[axis],
                               static_cast<double>(p[axis]) - box.upper[axis]});
    sum += d * d;
  }
  return sum * below;
}

}  // namespace kerf
