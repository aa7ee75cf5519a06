#include "workbench/compare/equal_references.hpp"

#include <algorithm>
#include <cmath>

#include "construction/construct.hpp"
#include "stages.hpp"

namespace workbench {
namespace {

// Numbers of references that differ by less than a thousandth are equal.
constexpr double tolerance = 1e-3;

// The secant rule takes three or four; a hierarchy that cannot have as many references is left after this.
constexpr int most_builds = 8;

// No step more than doubles what is allowed: where that is not enough, splitting has nothing more to give.
constexpr double longest_step = 2.0;

}  // namespace

std::size_t count_references(const kerf::Geometry& geometry, const kerf::BuildOptions& options) {
  return make_bvh(geometry, build_tree(geometry, options)).statistics().references;
}

std::size_t presplit_references_for(std::size_t references, const kerf::Geometry& geometry,
                                    kerf::BuildOptions options) {
  const auto target = static_cast<double>(references), whole = static_cast<double>(geometry.triangle_count());
  double allowed = target, best = target, least_error = target;
  double last_allowed = whole, last_reached = whole;
  for (int build = 0; build < most_builds; ++build) {
    options.presplit_references = static_cast<std::size_t>(allowed);
    const auto reached = static_cast<double>(count_references(geometry, options));
    if (std::abs(reached - target) < least_error) {
      least_error = std::abs(reached - target);
      best = allowed;
    }
    const double slope = (reached - last_reached) / (allowed - last_allowed);
    if (least_error <= tolerance * target || !(slope > 0.0)) break;
    last_allowed = allowed;
    last_reached = reached;
    allowed = std::clamp(std::round(allowed + (target - reached) / slope), whole, longest_step * allowed);
    if (allowed == last_allowed || allowed == whole) break;
  }
  return static_cast<std::size_t>(best);
}

}  // namespace workbench
