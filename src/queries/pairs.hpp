// The search for triangles of two hierarchies that touch, one of them moved.
#pragma once

#include <cmath>
#include <type_traits>

#include "base/raise.hpp"
#include "math/coordinate_limit.hpp"
#include "math/motion.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {

/// The motion of what lies within `bounds`. Throws `Error::invalid_argument` for numbers that exact
/// arithmetic has no room for.
inline Motion checked_motion(const Transform& transform, const Box3f& bounds) {
  for (const auto& row : transform.rows)
    for (const double number : row)
      if (!std::isfinite(number)) raise(Error::invalid_argument, "a number of the transform is not finite");
  const Motion motion(transform, bounds);
  const Box3f moved = motion(bounds);
  for (int axis = 0; axis < 3; ++axis)
    if (!(moved.lower[axis] > -coordinate_limit && moved.upper[axis] < coordinate_limit))
      raise(Error::invalid_argument, "the transform moves a mesh to coordinates of 2^126 and more");
  return motion;
}

/// All of two hierarchies, neither of which is empty.
inline BoxPair root_pair(const WideBvh& first, const WideBvh& second, const Motion& motion) {
  return {ChildLink::node(0), ChildLink::node(0), first.bounds, motion(second.bounds)};
}

/// Calls `visit(first, second)` for pairs of triangles below `start`, by number, perhaps more than once,
/// until it returns false. `first` is what `kernels` are for.
template <class Visit>
void visit_pairs(const Kernels& kernels, const WideBvh& first, const WideBvh& second, const Motion& motion,
                 const BoxPair& start, Visit&& visit) {
  kernels.visit_pairs(first, second, motion, start, &visit,
                      [](void* visitor, std::uint32_t a, std::uint32_t b) {
                        return (*static_cast<std::remove_reference_t<Visit>*>(visitor))(a, b);
                      });
}

}  // namespace kerf
