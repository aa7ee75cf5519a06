// Small things, beside Embree if it is available: rays in a scene of twelve triangles, short spans of rays
// beside as many single calls, and builds of many small meshes.
//
//     build/release/bin/small_bench [SCENE] [--benchmark_...]      (spans are traced in SCENE, or the atrium)
//
// Benchmarks that are compared with one another should run interleaved:
//
//     build/release/bin/small_bench --benchmark_enable_random_interleaving=true
//         --benchmark_repetitions=9 --benchmark_report_aggregates_only=true

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>
#include <tbb/global_control.h>

#include "workbench/bench/peer_isa.hpp"
#include "workbench/bench/peers/embree.hpp"
#include "workbench/bench/peers/kerf_engine.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/rays/rays.hpp"
#include "workbench/sampling/random.hpp"
#include "workbench/scene/viewpoints.hpp"

namespace {

using namespace workbench;

// A solid with one more vertex at the end, because Embree reads 16 bytes from any vertex.
struct PaddedSolid {
  Solid solid;

  explicit PaddedSolid(Solid given) : solid(std::move(given)) { solid.vertices.emplace_back(); }

  kerf::TriangleMesh mesh() const {
    return {.vertices = {solid.vertices.data(), solid.vertices.size() - 1, sizeof(kerf::Vec3f)},
            .triangles = solid.triangles};
  }
};

// kerf, and Embree with each of `isas`.
std::vector<Engine> make_engines(const std::vector<std::string>& isas) {
  kerf::BuildOptions options;
  options.threads = 1;
  std::vector<Engine> engines{kerf_engine(options, "")};
  for (const std::string& isa : isas) {
    for (Engine& engine : embree_engines(1, isa)) engines.push_back(std::move(engine));
  }
  return engines;
}

// Seconds per ray or mesh; of repetitions the best one counts.
void report(benchmark::internal::Benchmark* registered) {
  registered->ComputeStatistics("best", [](const std::vector<double>& values) {
    return *std::min_element(values.begin(), values.end());
  });
}

benchmark::Counter seconds_per_item(std::size_t items_per_iteration) {
  return {static_cast<double>(items_per_iteration),
          benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

// Single rays, made before each call, in a box of twelve triangles seen from inside and outside.
void add_twelve_triangles(const std::vector<std::string>& isas) {
  static const PaddedSolid box(make_box({-1, -1, -1}, {1, 1, 1}));
  Scene scene{
      .name = "box", .vertices = box.solid.vertices, .triangles = box.solid.triangles, .viewpoints = {}};
  scene.viewpoints = choose_viewpoints(box.mesh());
  const kerf::Bvh bvh = kerf::build(box.mesh());
  const std::vector<Engine> engines =
      make_engines(isas.empty() ? isas : std::vector{fastest_isa(scene, isas, {})});
  for (const RayType type : ray_types) {
    const RaySet set = make_rays(scene, bvh, type, {.width = 64, .height = 48});
    for (const Engine& engine : engines) {
      for (const Tracer& tracer : engine.build(box.mesh()).tracers) {
        if (!tracer.intersect_made) continue;
        report(benchmark::RegisterBenchmark(
            fmt::format("TwelveTriangles/{}/{}/{}", tracer.engine, engine.isa, name(type)).c_str(),
            [tracer, set](benchmark::State& state) {
              std::vector<kerf::Hit> hits(set.rays.size());
              std::vector<std::uint8_t> occluded(set.rays.size());
              for (auto _ : state) {
                if (set.any_hit()) {
                  tracer.occluded_made(set, 0, occluded);
                } else {
                  tracer.intersect_made(set, 0, hits);
                }
                benchmark::ClobberMemory();
              }
              state.counters["per_ray"] = seconds_per_item(set.rays.size());
            }));
      }
    }
  }
}

// The same rays of an array in spans of `length`, or one by one where `length` is 0.
void trace_spans(const kerf::Bvh& bvh, const RaySet& set, std::size_t length, std::vector<kerf::Hit>& hits,
                 std::vector<std::uint8_t>& occluded) {
  const std::span<const kerf::Ray> rays = set.rays;
  for (std::size_t i = 0; i < rays.size(); i += std::max<std::size_t>(length, 1)) {
    const std::size_t count = std::min(length, rays.size() - i);
    if (set.any_hit()) {
      if (length == 0) {
        occluded[i] = bvh.occluded(rays[i]);
      } else {
        bvh.occluded(rays.subspan(i, count), std::span(occluded).subspan(i, count));
      }
    } else {
      if (length == 0) {
        hits[i] = bvh.intersect(rays[i]).value_or(kerf::Hit{});
      } else {
        bvh.intersect(rays.subspan(i, count), std::span(hits).subspan(i, count));
      }
    }
  }
}

void add_spans(const std::string& spec) {
  const Scene scene = load_scene(spec);
  const kerf::Bvh bvh = kerf::build(scene.mesh());
  for (const RayType type : ray_types) {
    const RaySet set = make_rays(scene, bvh, type, {.width = 64, .height = 48});
    for (const std::size_t length : {0u, 1u, 4u, 16u, 64u}) {
      const std::string kind = length == 0 ? "single" : fmt::format("span_of_{}", length);
      report(benchmark::RegisterBenchmark(fmt::format("Spans/{}/{}", name(type), kind).c_str(),
                                          [bvh, set, length](benchmark::State& state) {
                                            std::vector<kerf::Hit> hits(set.rays.size());
                                            std::vector<std::uint8_t> occluded(set.rays.size());
                                            for (auto _ : state) {
                                              trace_spans(bvh, set, length, hits, occluded);
                                              benchmark::ClobberMemory();
                                            }
                                            state.counters["per_ray"] = seconds_per_item(set.rays.size());
                                          }));
    }
  }
}

// Ten thousand meshes of a hundred triangles each: tori of all proportions.
void add_small_meshes(const std::vector<std::string>& isas) {
  static const std::vector<PaddedSolid> tori = [] {
    std::vector<PaddedSolid> list;
    RandomNumbers random(1);
    for (int i = 0; i < 10'000; ++i) {
      const float ring = random.between(1.0f, 2.0f);
      list.emplace_back(make_torus(10, 5, ring, random.between(0.1f, 0.9f)));
    }
    return list;
  }();
  for (const Engine& engine : make_engines(isas)) {
    report(benchmark::RegisterBenchmark(fmt::format("SmallMeshes/{}/{}", engine.name, engine.isa).c_str(),
                                        [engine](benchmark::State& state) {
                                          for (auto _ : state) {
                                            for (const PaddedSolid& torus : tori) {
                                              benchmark::DoNotOptimize(engine.build(torus.mesh()));
                                            }
                                          }
                                          state.counters["per_mesh"] = seconds_per_item(tori.size());
                                        })
               ->Unit(benchmark::kMillisecond));
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  try {
    const std::vector<std::string> isas = isas_up_to(kerf::instruction_set(), embree_isas());
    add_twelve_triangles(isas);
    add_spans(argc > 1 ? argv[1] : "atrium");
    add_small_meshes(isas);
    benchmark::RunSpecifiedBenchmarks();
  } catch (const kerf::Error& error) {
    std::fprintf(stderr, "small_bench: %s\n", error.what());
    return 1;
  }
}
