// Tracing the binary tree itself, one box and one triangle at a time: the reference that wider kernels must
// equal.
#pragma once

#include <kerf/ray.hpp>

#include "kernel/counters.hpp"
#include "structure.hpp"

namespace kerf {

/// The closest hit, or of several at the same t the lowest triangle; its `primitive` is a triangle's number
/// in the `Geometry`. Counts into `counters` unless null.
Hit trace_closest(const Bvh::Structure& structure, const Ray& ray, TraversalCounters* counters);

/// Whether there is any hit.
bool trace_any(const Bvh::Structure& structure, const Ray& ray, TraversalCounters* counters);

}  // namespace kerf
