#include "workbench/compare/equal_references.hpp"

#include <algorithm>
#include <cmath>

namespace workbench {
namespace {

// Numbers of references that differ by less than a thousandth count as equal.
constexpr double tolerance = 1e-3;

// The secant method takes three or four builds. A hierarchy that cannot have as many references is given up
// after this many.
constexpr int max_builds = 8;

// One step at most doubles the number that is allowed. Where that does not suffice, splitting gains no more.
constexpr double max_growth = 2.0;

}  // namespace

std::size_t count_references(const kerf::TriangleMesh& mesh, const kerf::BuildOptions& options) {
  return kerf::build(mesh, options).statistics().references;
}

std::size_t presplit_references_for(std::size_t references, const kerf::TriangleMesh& mesh,
                                    kerf::BuildOptions options) {
  const auto target = static_cast<double>(references), whole = static_cast<double>(mesh.triangles.size());
  double allowed = target, best = target, min_error = target;
  double last_allowed = whole, last_reached = whole;
  for (int build = 0; build < max_builds; ++build) {
    options.presplit_references = static_cast<std::size_t>(allowed);
    const auto reached = static_cast<double>(count_references(mesh, options));
    if (std::abs(reached - target) < min_error) {
      min_error = std::abs(reached - target);
      best = allowed;
    }
    const double slope = (reached - last_reached) / (allowed - last_allowed);
    if (min_error <= tolerance * target || !(slope > 0.0)) break;
    last_allowed = allowed;
    last_reached = reached;
    allowed = std::clamp(std::round(allowed + (target - reached) / slope), whole, max_growth * allowed);
    if (allowed == last_allowed || allowed == whole) break;
  }
  return static_cast<std::size_t>(best);
}

}  // namespace workbench
