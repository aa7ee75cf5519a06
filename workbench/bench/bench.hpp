// kerf beside its peers: build time, memory and speed with the same mesh and the same rays, in the same run.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <kerf/build.hpp>

#include "workbench/bench/limits.hpp"
#include "workbench/bench/peers/engine.hpp"
#include "workbench/rays/rays.hpp"
#include "workbench/scene/scene.hpp"

namespace workbench {

struct BenchRays {
  RayType type = RayType::primary;
  std::size_t count = 0;
  std::size_t hits = 0;
  double mrays_per_s = 0.0;

  /// Of rays none of which hits anything, or of none at all, the time says nothing about an engine.
  std::optional<double> speed() const { return hits > 0 ? std::optional(mrays_per_s) : std::nullopt; }
};

/// Where rays are when they are traced.
enum class RaysMade {
  made,   ///< each is computed and written right before its call, and its hit used right behind it
  array,  ///< all lie in memory before the clock starts
};

std::string_view name(RaysMade where);

/// One way of tracing the structure of one engine.
struct BenchResult {
  std::string engine;
  std::string mode;
  std::string isa;                       ///< the instruction set of the engine
  RaysMade rays_made = RaysMade::array;  ///< always `array` where spans or packets are traced
  double build_ms = 0.0;
  std::size_t bytes = 0;
  std::size_t build_peak_bytes = 0;
  std::vector<BenchRays> rays;  ///< in the order of `ray_types`
};

struct BenchScene {
  std::string name;
  std::size_t triangles = 0;   ///< counted at each place
  double sah = 0.0;            ///< of kerf's tree; 0 for meshes at places
  std::size_t references = 0;  ///< of kerf's tree; 0 for meshes at places
  std::size_t instances = 0;   ///< 0 for one mesh
  std::size_t meshes = 1;
  std::vector<BenchResult> results;
  std::vector<std::string> remarks = {};  ///< on what the figures do not say: see `remarks_on`
  std::optional<Limits> limits = {};      ///< of kerf, if they were asked for
};

struct BenchOptions {
  unsigned threads = 1;
  kerf::Quality quality = kerf::Quality::fast;  ///< of the tree that is described and whose steps are counted
  unsigned build_rounds = 5;                    ///< the best one counts; another round before them warms up
  unsigned trace_rounds = 5;                    ///< at least; another round before them warms up
  double trace_seconds = 2.0;  ///< more rounds follow until those of one type of rays took as long
  RaySetOptions rays;
  /// Of rays that are traced one by one; of two, both are measured, interleaved as all else.
  std::vector<RaysMade> rays_made{RaysMade::made};
  bool limits = false;  ///< also measure how fast kerf could be at best
  std::function<void(double fraction, std::string_view what)> progress;
};

/// How vertices move while `bench_motion` measures.
struct Motion {
  double amount = 0.03;  ///< a part of the extent of the mesh
  unsigned frames = 8;   ///< the best one counts; two before them warm up
};

/// One way in which an engine follows vertices that move.
struct MotionResult {
  std::string engine;
  std::string motion;  ///< "refit" or "rebuild"
  std::string isa;
  double frame_ms = 0.0;
  std::vector<BenchRays> rays;  ///< single ones through the last frame, in the order of `ray_types`
};

struct MotionScene {
  std::string name;
  std::size_t triangles = 0;
  double amount = 0.0;  ///< of `Motion`
  RaysMade rays_made = RaysMade::made;
  std::vector<MotionResult> results;
  std::vector<std::string> remarks = {};
};

/// Sentences on peers whose hits differ from kerf's by more than leaks at edges explain: they did not trace
/// the same, and their speed is none to compare with.
std::vector<std::string> remarks_on(const BenchScene& scene);

/// Builds and traces `scene` with all `engines`, meshes at places with those that can. Rounds of the engines
/// are interleaved, so that what slows the machine for a while slows all of them.
BenchScene bench_scene(const Scene& scene, std::span<const Engine> engines, const BenchOptions& options);

/// The mesh of `scene` bends, frame after frame (see `bend`), and each engine follows in all of its ways: how
/// long a frame takes, and how fast rays are after the last one. Interleaved as `bench_scene`.
MotionScene bench_motion(const Scene& scene, std::span<const Engine> engines, const BenchOptions& options,
                         const Motion& motion);

}  // namespace workbench
