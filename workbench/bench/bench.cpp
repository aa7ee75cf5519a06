#include "workbench/bench/bench.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include <kerf/kerf.hpp>
#include <tbb/global_control.h>

#include "construction/construct.hpp"
#include "tree/measures/measures.hpp"

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

  void show(double part, std::string_view what) const {
    if (options_.progress) options_.progress(part, scene_ + ": " + std::string(what));
  }

 private:
  const BenchOptions& options_;
  const std::string& scene_;
};

struct Build {
  double best_seconds = std::numeric_limits<double>::infinity();
  Traceable traceable;
};

std::vector<Build> build_all(std::span<const Engine> engines, const kerf::TriangleMesh& mesh,
                             const BenchOptions& options, const Progress& progress) {
  std::vector<Build> builds(engines.size());
  for (unsigned round = 0; round <= options.build_rounds; ++round) {
    for (std::size_t e = 0; e < engines.size(); ++e) {
      progress.show(0.5 * round / (options.build_rounds + 1), "building " + engines[e].name);
      builds[e].traceable = {};  // the memory of the last round is given back before the clock starts
      const double time = seconds([&] { builds[e].traceable = engines[e].build(mesh); });
      if (round > 0) builds[e].best_seconds = std::min(builds[e].best_seconds, time);
    }
  }
  return builds;
}

// Rays that are handed over and timed together. A disturbance of the machine must hit the same slice in every
// round to show; yet a slice is long enough (some milliseconds) for threads to be worth starting and rays to
// be sorted.
constexpr std::size_t slice_size = 16384;

class RayTimer {
 public:
  RayTimer(const RaySet& set, const Tracer& tracer)
      : set_(set), tracer_(tracer), best_((set.rays.size() + slice_size - 1) / slice_size, Slice{}) {}

  /// Returns the seconds that it took.
  double trace_once() {
    double total = 0.0;
    for (std::size_t i = 0; i < best_.size(); ++i) {
      const std::size_t begin = i * slice_size;
      const Slice slice =
          trace(std::span(set_.rays).subspan(begin).first(std::min(slice_size, set_.rays.size() - begin)));
      if (slice.seconds < best_[i].seconds) best_[i] = slice;
      total += slice.seconds;
    }
    return total;
  }

  BenchRays figures() const {
    BenchRays rays{.type = set_.type, .count = set_.rays.size(), .hits = 0, .mrays_per_s = 0.0};
    double total = 0.0;
    for (const Slice& slice : best_) {
      rays.hits += slice.hits;
      total += slice.seconds;
    }
    rays.mrays_per_s = 1e-6 * static_cast<double>(rays.count) / total;
    return rays;
  }

 private:
  struct Slice {
    double seconds = std::numeric_limits<double>::infinity();
    std::size_t hits = 0;
  };

  Slice trace(std::span<const kerf::Ray> rays) {
    Slice slice;
    if (set_.any_hit()) {
      std::vector<std::uint8_t> occluded(rays.size());
      slice.seconds = seconds([&] { tracer_.occluded(rays, occluded); });
      slice.hits = static_cast<std::size_t>(std::count(occluded.begin(), occluded.end(), 1));
    } else {
      std::vector<kerf::Hit> hits(rays.size());
      slice.seconds = seconds([&] { tracer_.intersect(rays, hits); });
      slice.hits = static_cast<std::size_t>(
          std::count_if(hits.begin(), hits.end(), [](const kerf::Hit& hit) { return bool(hit); }));
    }
    return slice;
  }

  const RaySet& set_;
  const Tracer& tracer_;
  std::vector<Slice> best_;
};

std::vector<BenchRays> trace_all(std::span<const Tracer> tracers, const RaySet& set,
                                 const BenchOptions& options) {
  std::vector<RayTimer> timers;
  for (const Tracer& tracer : tracers) {
    RayTimer(set, tracer).trace_once();  // warms up
    timers.emplace_back(set, tracer);
  }
  double spent = 0.0;
  for (unsigned round = 0; round < options.trace_rounds || spent < options.trace_seconds; ++round) {
    for (RayTimer& timer : timers) spent += timer.trace_once();
  }
  std::vector<BenchRays> figures;
  for (const RayTimer& timer : timers) figures.push_back(timer.figures());
  return figures;
}

}  // namespace

BenchScene bench_scene(const Scene& scene, std::span<const Engine> engines, const BenchOptions& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, options.threads);
  const Progress progress(options, scene.name);

  // All engines read the same arrays. One more vertex makes it safe to read 16 bytes from the last that is
  // used.
  std::vector<kerf::Vec3f> vertices = scene.vertices;
  vertices.emplace_back();
  const kerf::TriangleMesh mesh{.vertices = {vertices.data(), scene.vertices.size(), sizeof(kerf::Vec3f)},
                                .triangles = scene.triangles};

  BenchScene figures{.name = scene.name, .triangles = scene.triangles.size(), .results = {}};
  std::vector<Build> builds = build_all(engines, mesh, options, progress);
  std::vector<Tracer> tracers;
  for (const Build& build : builds) {
    for (const Tracer& tracer : build.traceable.tracers) {
      tracers.push_back(tracer);
      figures.results.push_back({.engine = tracer.engine,
                                 .mode = tracer.mode,
                                 .build_ms = 1e3 * build.best_seconds,
                                 .bytes = build.traceable.bytes,
                                 .build_peak_bytes = build.traceable.build_peak_bytes,
                                 .rays = {}});
    }
  }

  kerf::BuildOptions defaults;
  defaults.threads = options.threads;
  const kerf::Bvh bvh = kerf::build(mesh, defaults);
  if (options.limits) figures.limits = {.times = measure_steps(), .counts = {}};
  double part = 0.5;
  for (const RayType type : ray_types) {
    progress.show(part, "tracing " + std::string(name(type)));
    part += 0.5 / std::size(ray_types);
    const RaySet set = make_rays(scene, bvh, type, options.rays);
    const std::vector<BenchRays> rays = trace_all(tracers, set, options);
    for (std::size_t i = 0; i < rays.size(); ++i) figures.results[i].rays.push_back(rays[i]);
    if (figures.limits) figures.limits->counts[static_cast<std::size_t>(type)] = count_steps(bvh, set);
  }

  const kerf::BinaryTree tree = kerf::build_tree(kerf::Geometry({&mesh, 1}), defaults);
  figures.sah = kerf::surface_area_cost(tree);
  figures.references = tree.references.size();
  return figures;
}

}  // namespace workbench
