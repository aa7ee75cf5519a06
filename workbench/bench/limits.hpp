// How fast a single ray could be traced at best on this machine: if it waited for no memory, no branch and no
// result of the step before.
#pragma once

#include <array>
#include <span>

#include <kerf/bvh.hpp>

#include "workbench/rays/rays.hpp"

namespace workbench {

/// What one step costs with everything in the first-level cache, steps following each other as closely as the
/// machine can overlap them.
struct StepTimes {
  double node_ns = 0.0;  ///< a ray against the boxes of a node, and those that it meets put in order
  double leaf_ns = 0.0;  ///< a ray against the triangles of a leaf, all of which it misses
};

/// Measures the kernels that `kerf::build` chooses here, in a few milliseconds.
StepTimes measure_steps();

/// Steps of `Bvh::intersect` or `Bvh::occluded`, a ray.
struct StepCounts {
  double nodes = 0.0;
  double leaves = 0.0;
};

StepCounts count_steps(const kerf::Bvh& bvh, const RaySet& set);

/// The least that a ray can take.
constexpr double floor_ns(const StepTimes& times, const StepCounts& counts) {
  return times.node_ns * counts.nodes + times.leaf_ns * counts.leaves;
}

/// That floor as a part of what a ray took. Packets may exceed 1: one step of theirs serves many rays.
constexpr double efficiency(double floor, double mrays_per_s) {
  return floor * mrays_per_s * 1e-3;
}

struct Limits {
  StepTimes times;
  std::array<StepCounts, std::size(ray_types)> counts;  ///< in the order of `ray_types`
};

}  // namespace workbench
