// Hierarchies over one scene, measured with the same rays in the same run.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <kerf/build.hpp>

#include "workbench/rays/rays.hpp"
#include "workbench/scene/scene.hpp"

namespace workbench {

/// One way to build, and its name in the tables.
struct Contender {
  std::string name;
  kerf::BuildOptions options;
};

/// What the rays of one type did in one hierarchy.
struct RayFigures {
  std::size_t count = 0;
  std::size_t hits = 0;
  double steps = 0.0;               ///< inner-node visits per ray
  double triangle_tests = 0.0;      ///< triangle tests per ray
  double leaf_visits = 0.0;         ///< per ray; 0 where a device does not count them
  double median_mrays_per_s = 0.0;  ///< in the middle one of the rounds
  double mrays_per_s = 0.0;  ///< on one thread (see `time_slices`) or on the device, the builders in turn
};

/// What one contender built, and its measures.
struct BuilderFigures {
  std::string name;
  std::string structure = {};  ///< the form of the tree that a device traces; empty on the CPU
  float alpha = 0.0f;
  float budget = 0.0f;    ///< `max_reference_ratio`
  double build_ms = 0.0;  ///< best of the rounds; esc and evh include the search for their threshold
  double sah = 0.0;
  double epo = 0.0;
  double epo_error = 0.0;  ///< standard error of `epo`; 0 where it is exact
  double lcv = 0.0;
  std::size_t references = 0;
  std::size_t nodes = 0;
  std::size_t bytes = 0;
  std::array<RayFigures, std::size(ray_types)> rays;  ///< in the order of `ray_types`
  std::size_t disagreements = 0;  ///< rays whose hit differs, in any bit, from that of the first contender
};

struct SceneFigures {
  std::string name;
  std::string device = {};  ///< that traced; empty for the CPU
  std::size_t triangles = 0;
  std::size_t degenerate_triangles = 0;
  std::string remark = {};               ///< on how it was measured, if that is not as always
  std::vector<BuilderFigures> builders;  ///< in the order of the contenders

  std::size_t disagreements() const;
};

class TracingDevice;

struct CompareOptions {
  TracingDevice* device = nullptr;  ///< that traces in place of the CPU, each tree in each of its structures
  unsigned threads = 0;             ///< that build and count, 0 for all there are; rays are timed on one
  RaySetOptions rays = {};          ///< size of each viewpoint's picture
  bool bound_rays = true;           ///< smaller pictures where rays visit so much that it would take hours
  std::uint64_t max_visits = max_visits_of_a_pass;  ///< where rays are bounded: see `affordable`
  unsigned rounds = 3;                              ///< of timing, at least
  double seconds_per_type = 1.0;  ///< more rounds follow until all hierarchies together traced for this long

  /// Called with the fraction of the work that is done and a word for what comes next. Must not throw.
  std::function<void(double fraction, std::string_view what)> progress = {};
};

/// Figures, and the hierarchies of the CPU that they belong to.
struct Comparison {
  SceneFigures figures;
  std::vector<kerf::Bvh> hierarchies = {};
};

/// Builds and measures. The `esc` and `evh` contenders whose `presplit_references` is 0 are given as many
/// references as the SBVH with the same alpha has. That SBVH is built first, whether it is a contender or
/// not.
Comparison compare(const Scene& scene, std::span<const Contender> contenders, const CompareOptions& options);
}  // namespace workbench
