#include "workbench/bench/bench.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>
#include <tbb/global_control.h>

#include "workbench/rays/slice_timer.hpp"
#include "workbench/scene/bend.hpp"
#include "workbench/scene/placed.hpp"
#include "workbench/scene/traced.hpp"

namespace workbench {
namespace {

template <class Function>
double seconds(const Function& function) {
  const auto start = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Progress {
 public:
  Progress(const BenchOptions& options, const std::string& scene) : options_(options), scene_(scene) {}

  void show(double fraction, std::string_view what) const {
    if (options_.progress) options_.progress(fraction, scene_ + ": " + std::string(what));
  }

 private:
  const BenchOptions& options_;
  const std::string& scene_;
};

struct Build {
  double best_seconds = std::numeric_limits<double>::infinity();
  Traceable traceable;
};

// `build(engine)` is what is timed.
template <class MakeTraceable>
std::vector<Build> build_all(std::span<const Engine> engines, const MakeTraceable& build,
                             const BenchOptions& options, const Progress& progress) {
  std::vector<Build> builds(engines.size());
  for (unsigned round = 0; round <= options.build_rounds; ++round) {
    for (std::size_t e = 0; e < engines.size(); ++e) {
      progress.show(0.5 * round / (options.build_rounds + 1), "building " + engines[e].name);
      builds[e].traceable = {};  // frees the memory of the last round before the clock starts
      const double time = seconds([&] { builds[e].traceable = build(engines[e]); });
      if (round > 0) builds[e].best_seconds = std::min(builds[e].best_seconds, time);
    }
  }
  return builds;
}

// Rays per slice, which is handed to a tracer as one span. A slice takes some milliseconds: long enough for
// threads to be worth starting and for rays to be sorted, short enough for most slices to run undisturbed.
constexpr std::size_t slice_size = 16384;

// A tracer, and where its rays are.
struct Way {
  Tracer tracer;
  RaysMade rays_made;
};

std::vector<Way> ways(const Tracer& tracer, const BenchOptions& options) {
  if (!tracer.intersect_made) return {{tracer, RaysMade::array}};
  std::vector<Way> list;
  for (const RaysMade where : options.rays_made) list.push_back({tracer, where});
  return list;
}

// Traces a set of rays in spans, with results in memory for one span.
class SpanTracer {
 public:
  SpanTracer(const RaySet& set, const Way& way)
      : set_(set), tracer_(way.tracer), make_(way.rays_made == RaysMade::made) {}

  void trace(std::size_t begin, std::size_t end) {
    const auto rays = std::span(set_.rays).subspan(begin, end - begin);
    if (set_.any_hit()) {
      occluded_.resize(rays.size());
      make_ ? tracer_.occluded_made(set_, begin, occluded_) : tracer_.occluded(rays, occluded_);
    } else {
      hits_.resize(rays.size());
      make_ ? tracer_.intersect_made(set_, begin, hits_) : tracer_.intersect(rays, hits_);
    }
  }

  // Of the span that was traced last.
  std::size_t hit_count() const {
    const auto count = set_.any_hit() ? std::count(occluded_.begin(), occluded_.end(), 1)
                                      : std::count_if(hits_.begin(), hits_.end(),
                                                      [](const kerf::Hit& hit) { return bool(hit); });
    return static_cast<std::size_t>(count);
  }

 private:
  const RaySet& set_;
  const Tracer& tracer_;
  const bool make_;
  std::vector<std::uint8_t> occluded_;
  std::vector<kerf::Hit> hits_;
};

std::vector<BenchRays> trace_all(std::span<const Way> ways, const RaySet& set, const BenchOptions& options) {
  const std::size_t ray_count = set.rays.size();
  std::vector<BenchRays> figures;
  std::vector<SpanTracer> span_tracers;
  std::vector<TraceRange> trace_ranges;
  span_tracers.reserve(ways.size());  // the functions below refer to its elements
  for (const Way& way : ways) {
    SpanTracer& span_tracer = span_tracers.emplace_back(set, way);
    std::size_t hits = 0;
    for (std::size_t begin = 0; begin < ray_count; begin += slice_size) {  // this also warms up
      span_tracer.trace(begin, std::min(begin + slice_size, ray_count));
      hits += span_tracer.hit_count();
    }
    figures.push_back({.type = set.type, .count = ray_count, .hits = hits, .mrays_per_s = 0.0});
    trace_ranges.emplace_back(
        [&span_tracer](std::size_t begin, std::size_t end) { span_tracer.trace(begin, end); });
  }
  if (ray_count == 0) return figures;
  const std::vector<SliceTimes> times =
      time_slices(trace_ranges, ray_count, (ray_count + slice_size - 1) / slice_size,
                  {.rounds = options.trace_rounds, .seconds = options.trace_seconds});
  for (std::size_t i = 0; i < figures.size(); ++i) {
    figures[i].mrays_per_s = 1e-6 * static_cast<double>(ray_count) / times[i].seconds;
  }
  return figures;
}

// Traces the rays of each type, `make_set(type)`, in all ways, and adds what that gives to the results of
// these ways. `visit_set` sees each set last.
template <class Result, class MakeSet, class VisitSet>
void trace_types(std::span<const Way> ways, const BenchOptions& options, const Progress& progress,
                 std::vector<Result>& results, const MakeSet& make_set, const VisitSet& visit_set) {
  double fraction = 0.5;
  for (const RayType type : ray_types) {
    progress.show(fraction, "tracing " + std::string(name(type)));
    fraction += 0.5 / std::size(ray_types);
    const RaySet set = make_set(type);
    const std::vector<BenchRays> rays = trace_all(ways, set, options);
    for (std::size_t i = 0; i < rays.size(); ++i) results[i].rays.push_back(rays[i]);
    visit_set(set);
  }
}
void ignore(const RaySet&) {}

// See `remarks_on`. The first result is kerf's.
template <class Result>
std::vector<std::string> remarks_on_peers(const std::vector<Result>& results) {
  // Rays that leak between triangles are some per million. Where surfaces touch, that one or another of them
  // is hit changes no count.
  constexpr double leaks = 0.005;
  constexpr double a_few = 16.0;
  std::vector<std::string> remarks;
  if (results.empty() || results.front().engine != "kerf") return remarks;
  const Result& kerf = results.front();
  for (const Result& peer : results) {
    if (peer.engine == "kerf") continue;
    for (std::size_t i = 0; i < std::min(peer.rays.size(), kerf.rays.size()); ++i) {
      const double ours = static_cast<double>(kerf.rays[i].hits),
                   theirs = static_cast<double>(peer.rays[i].hits);
      if (std::abs(ours - theirs) <= std::max(leaks * std::max(ours, theirs), a_few)) continue;
      remarks.push_back(fmt::format(
          "{} hits {} of the {} rays that kerf hits {} of, {}. It did not do the same work, so its speed is "
          "none "
          "to compare with. Boxes without thickness, of flat meshes, and coordinates of 1e18 and more are "
          "what "
          "traversals without bounds on their rounding miss.",
          peer.engine, peer.rays[i].hits, peer.rays[i].count, kerf.rays[i].hits, name(peer.rays[i].type)));
      break;  // the first type says it
    }
  }
  return remarks;
}

// Of a `BenchScene` or a `MotionScene`.
template <class Figures>
void add_remarks(Figures& figures, const RaySetOptions& given, const RaySetOptions& asked) {
  figures.remarks = remarks_on_peers(figures.results);
  if (given == asked) return;
  figures.remarks.push_back(fmt::format(
      "Each viewpoint has {}x{} pixels, not {}x{}: so much lies over one another that a ray visits "
      "thousands of nodes and triangles.",
      given.width, given.height, asked.width, asked.height));
}

}  // namespace

std::string_view name(RaysMade where) {
  return where == RaysMade::made ? "made" : "array";
}

BenchScene bench_scene(const Scene& scene, std::span<const Engine> engines, const BenchOptions& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, options.threads);
  const Progress progress(options, scene.name);

  // All engines read the same arrays. One more vertex at the end makes it safe to read 16 bytes from any
  // vertex in use.
  std::vector<kerf::Vec3f> vertices = scene.vertices;
  vertices.emplace_back();
  const kerf::TriangleMesh mesh{.vertices = {vertices.data(), scene.vertices.size(), sizeof(kerf::Vec3f)},
                                .triangles = scene.triangles};

  BenchScene figures{.name = scene.name, .triangles = scene.triangle_count(), .results = {}};
  std::vector<Build> builds = build_all(
      engines,
      [&](const Engine& engine) {
        return scene.placed ? engine.build_placed(*scene.placed) : engine.build(mesh);
      },
      options, progress);
  std::vector<Way> all_ways;
  for (std::size_t e = 0; e < engines.size(); ++e) {
    const Build& build = builds[e];
    for (const Tracer& tracer : build.traceable.tracers) {
      for (Way& way : ways(tracer, options)) {
        figures.results.push_back({.engine = tracer.engine,
                                   .mode = tracer.mode,
                                   .isa = engines[e].isa,
                                   .rays_made = way.rays_made,
                                   .build_ms = 1e3 * build.best_seconds,
                                   .bytes = build.traceable.bytes,
                                   .build_peak_bytes = build.traceable.build_peak_bytes,
                                   .rays = {}});
        all_ways.push_back(std::move(way));
      }
    }
  }

  const kerf::BuildOptions build_options{.quality = options.quality, .threads = options.threads};
  if (scene.placed) {
    figures.instances = scene.placed->places.size();
    figures.meshes = scene.placed->meshes.size();
    const kerf::Scene places =
        build_scene(*scene.placed, build_objects(*scene.placed, build_options), build_options);
    const RaySetOptions pixels = affordable(scene, build_stand_in(*scene.placed), options.rays);
    trace_types(
        all_ways, options, progress, figures.results,
        [&](RayType type) { return make_rays(Traced(scene, places), type, pixels); }, ignore);
    add_remarks(figures, pixels, options.rays);
    return figures;
  }

  const kerf::Bvh bvh = kerf::build(mesh, build_options);
  const RaySetOptions pixels = affordable(scene, bvh, options.rays);
  if (options.limits) figures.limits = {.times = measure_steps(), .counts = {}};
  trace_types(
      all_ways, options, progress, figures.results,
      [&](RayType type) { return make_rays(scene, bvh, type, pixels); },
      [&](const RaySet& set) {
        if (figures.limits)
          figures.limits->counts[static_cast<std::size_t>(set.type)] = count_steps(bvh, set);
      });
  const kerf::Tree tree = kerf::build_tree(mesh, build_options);
  figures.sah = kerf::surface_area_cost(tree);
  figures.references = tree.references().size();
  add_remarks(figures, pixels, options.rays);
  return figures;
}

MotionScene bench_motion(const Scene& scene, std::span<const Engine> engines, const BenchOptions& options,
                         const Motion& motion) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, options.threads);
  const Progress progress(options, scene.name);
  Scene bent = scene;
  // One more vertex at the end, as in `bench_scene`. Engines keep to these arrays.
  bent.vertices.emplace_back();
  const kerf::TriangleMesh mesh{
      .vertices = {bent.vertices.data(), scene.vertices.size(), sizeof(kerf::Vec3f)},
      .triangles = bent.triangles};
  MotionScene figures{.name = scene.name,
                      .triangles = scene.triangle_count(),
                      .amount = motion.amount,
                      .rays_made = options.rays_made.front(),
                      .results = {}};
  std::vector<Mover> movers;
  for (const Engine& engine : engines) {
    if (!engine.movers) continue;
    for (Mover& mover : engine.movers(mesh)) {
      figures.results.push_back({.engine = mover.engine,
                                 .motion = mover.motion,
                                 .isa = engine.isa,
                                 .frame_ms = std::numeric_limits<double>::infinity(),
                                 .rays = {}});
      movers.push_back(std::move(mover));
    }
  }
  constexpr unsigned warm_up = 2;  // the first refit also finds the parts of triangles that were split
  constexpr double step = 0.7;     // of the wave, from frame to frame
  for (unsigned frame = 0; frame < motion.frames + warm_up; ++frame) {
    progress.show(0.5 * frame / (motion.frames + warm_up), "moving");
    bend(scene.vertices, motion.amount, step * frame, std::span(bent.vertices).first(scene.vertices.size()));
    for (std::size_t i = 0; i < movers.size(); ++i) {
      const double ms = 1e3 * seconds(movers[i].next_frame);
      if (frame >= warm_up) figures.results[i].frame_ms = std::min(figures.results[i].frame_ms, ms);
    }
  }

  std::vector<Way> all_ways;
  for (const Mover& mover : movers) all_ways.push_back({mover.tracer(), figures.rays_made});
  const kerf::Bvh bvh = kerf::build(mesh, {.quality = options.quality, .threads = options.threads});
  bent.vertices.pop_back();
  const RaySetOptions pixels = affordable(bent, bvh, options.rays);
  trace_types(
      all_ways, options, progress, figures.results,
      [&](RayType type) { return make_rays(bent, bvh, type, pixels); }, ignore);
  add_remarks(figures, pixels, options.rays);
  return figures;
}

std::vector<std::string> remarks_on(const BenchScene& scene) {
  return remarks_on_peers(scene.results);
}

}  // namespace workbench
