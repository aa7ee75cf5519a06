// The leaves that a ray meets, for hierarchies whose leaves hold more than triangles.
#pragma once

#include <kerf/ray.hpp>

#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"

namespace kerf {

/// Calls `visit` for the leaves whose boxes the ray meets, the nearest first. All boxes are grown by `margin`
/// units of 2^-24 of the distance to the far side of the hierarchy, on top of what kernels grow them by.
/// `visit` returns the t up to which the ray goes on, or -infinity to end it. The nodes must be as wide as
/// those that kernels of the target trace.
void visit_leaves(Target target, const WideBvh& bvh, const Ray& ray, float margin, void* visitor,
                  float (*visit)(void* visitor, ChildLink leaf));

}  // namespace kerf
