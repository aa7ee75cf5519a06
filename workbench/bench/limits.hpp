// How fast a single ray could be traced at best on this machine: if it never waited for memory, for a branch
// or for the result of the step before.
#pragma once

#include <array>
#include <span>

#include <kerf/bvh.hpp>

#include "workbench/rays/rays.hpp"

namespace workbench {

/// The time of one step with everything in the first-level cache, where consecutive steps overlap as far as
/// the machine allows.
struct StepTimes {
  double node_ns = 0.0;  ///< tests the boxes of a node and sorts those that the ray meets
  double leaf_ns = 0.0;  ///< tests the triangles of a leaf, all of which the ray misses
};

/// Measures the kernels that `kerf::build` chooses here, in a few milliseconds.
StepTimes measure_steps();

/// Steps of `Bvh::intersect` or `Bvh::occluded` per ray.
struct StepCounts {
  double nodes = 0.0;
  double leaves = 0.0;
};

StepCounts count_steps(const kerf::Bvh& bvh, const RaySet& set);

/// The time that a ray takes at least.
constexpr double floor_ns(const StepTimes& times, const StepCounts& counts) {
  return times.node_ns * counts.nodes + times.leaf_ns * counts.leaves;
}

/// The floor divided by the time that a ray took. Packets may exceed 1: one of their steps serves many rays.
constexpr double efficiency(double floor, double mrays_per_s) {
  return floor * mrays_per_s * 1e-3;
}

struct Limits {
  StepTimes times;
  std::array<StepCounts, std::size(ray_types)> counts;  ///< in the order of `ray_types`
};

}  // namespace workbench
