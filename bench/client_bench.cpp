// What programs ask of rays beside the plain call, on one thread: rays that start at vertices, as baking per
// vertex has them, beside rays that start in faces; filters; masks. Plain rays also by Embree, if it is
// available.
//
//     build/release/bin/client_bench SCENE [--benchmark_...]      (the atrium if no scene is named)
//
// Benchmarks that are compared with one another should run interleaved:
//
//     build/release/bin/client_bench SCENE --benchmark_enable_random_interleaving=true
//         --benchmark_repetitions=9 --benchmark_report_aggregates_only=true

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>
#include <tbb/global_control.h>

#include "workbench/base/vectors.hpp"
#include "workbench/bench/peer_isa.hpp"
#include "workbench/bench/peers/embree.hpp"
#include "workbench/bench/peers/kerf_engine.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/sampling/random.hpp"
#include "workbench/sampling/random_direction.hpp"

namespace {

using namespace workbench;
constexpr std::size_t ray_count = 100'000;

// As many of both, each pair in the same direction from the same triangle.
struct Starts {
  std::vector<kerf::Ray> faces, vertices;
};

// To the front side of random triangles, from a ten-thousandth of the scene's diagonal on, and up to `reach`
// diagonals.
Starts make_starts(const Scene& scene, const Box3f& box, float reach) {
  RandomNumbers random(1);
  const float diagonal = length(box.upper - box.lower);
  Starts starts;
  while (starts.faces.size() < ray_count) {
    const auto& [i, j, k] = scene.triangles[random.below(static_cast<std::uint32_t>(scene.triangles.size()))];
    const Vec3f a = scene.vertices[i], along = scene.vertices[j] - a, across = scene.vertices[k] - a;
    const float u = random.uniform();
    const float v = random.uniform();
    const Vec3f direction = random_direction(random);
    if (u + v > 1.0f) continue;
    const float side = dot(cross(along, across), direction) < 0.0f ? -1.0f : 1.0f;
    kerf::Ray ray{.origin = a + u * along + v * across,
                  .direction = side * direction,
                  .t_min = 1e-4f * diagonal,
                  .t_max = reach * diagonal};
    starts.faces.push_back(ray);
    ray.origin = a;
    starts.vertices.push_back(ray);
  }
  return starts;
}

// Calls `trace` with all rays an iteration, and reports seconds per ray; of repetitions the best one counts.
template <class Trace>
void add(const std::string& name, const std::vector<kerf::Ray>& rays, const Trace& trace) {
  benchmark::RegisterBenchmark(name.c_str(), [rays, trace](benchmark::State& state) {
    for (auto _ : state) trace(std::span<const kerf::Ray>(rays));
    state.counters["per_ray"] = {static_cast<double>(rays.size()),
                                 benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
  })->ComputeStatistics("best", [](const std::vector<double>& values) {
    return *std::min_element(values.begin(), values.end());
  });
}

// How many of the rays hit something by `intersect(ray)`.
template <class Intersect>
void add_kerf(const std::string& name, const std::vector<kerf::Ray>& rays, const Intersect& intersect) {
  add(name, rays, [intersect](std::span<const kerf::Ray> all) {
    std::size_t hits = 0;
    for (const kerf::Ray& ray : all) hits += static_cast<bool>(intersect(ray));
    benchmark::DoNotOptimize(hits);
  });
}

void run(const std::string& spec) {
  const Scene scene = load_scene(spec);
  kerf::TriangleMesh mesh = scene.mesh();
  mesh.mask = kerf::Mask{1};  // so that masks are looked at
  kerf::BuildOptions options;
  options.threads = 1;
  const kerf::Bvh bvh = kerf::build(mesh, options);
  const Starts open = make_starts(scene, bvh.bounds(), std::numeric_limits<float>::infinity()),
               near = make_starts(scene, bvh.bounds(), 0.25f);

  std::vector<Engine> engines{kerf_engine(options, "")};
  const std::vector<std::string> isas = isas_up_to(kerf::instruction_set(), embree_isas());
  if (!isas.empty()) {
    for (Engine& engine : embree_engines(1, fastest_isa(scene, isas, {})))
      engines.push_back(std::move(engine));
  }
  for (const Engine& engine : engines) {
    if (engine.name != "kerf" && engine.name != "embree-high") continue;
    for (const Tracer& tracer : engine.build(scene.mesh()).tracers) {
      if (tracer.mode != "single") continue;
      const auto closest = [tracer](std::span<const kerf::Ray> rays) {
        static std::vector<kerf::Hit> hits(ray_count);
        tracer.intersect(rays, hits);
      };
      const auto any = [tracer](std::span<const kerf::Ray> rays) {
        static std::vector<std::uint8_t> occluded(ray_count);
        tracer.occluded(rays, occluded);
      };
      add(fmt::format("Closest/{}/faces", tracer.engine), open.faces, closest);
      add(fmt::format("Closest/{}/vertices", tracer.engine), open.vertices, closest);
      add(fmt::format("Any/{}/faces", tracer.engine), near.faces, any);
      add(fmt::format("Any/{}/vertices", tracer.engine), near.vertices, any);
    }
  }
  const auto all = [](const kerf::Hit&) { return true; };
  const auto two_of_three = [](const kerf::Hit& hit) { return hit.primitive % 3 != 0; };
  add_kerf("Filter/none", open.faces, [bvh](const kerf::Ray& ray) { return bvh.intersect(ray); });
  add_kerf("Filter/all", open.faces, [bvh, all](const kerf::Ray& ray) { return bvh.intersect(ray, all); });
  add_kerf("Filter/two_of_three", open.faces,
           [bvh, two_of_three](const kerf::Ray& ray) { return bvh.intersect(ray, two_of_three); });
  add_kerf("Mask/shared", open.faces,
           [bvh](const kerf::Ray& ray) { return bvh.intersect(ray, kerf::Mask{1}); });
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  try {
    run(argc > 1 ? argv[1] : "atrium");
    benchmark::RunSpecifiedBenchmarks();
  } catch (const kerf::Error& error) {
    std::fprintf(stderr, "client_bench: %s\n", error.what());
    return 1;
  }
}
