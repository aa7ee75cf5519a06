// The time of builds of small meshes, of which programs with many objects make thousands, beside Embree's of
// medium quality.
//
//     build/release/bin/small_build_bench
#include <vector>

#include <benchmark/benchmark.h>
#include <kerf/kerf.hpp>

#include "workbench/generate/solids.hpp"

#ifdef KERF_EMBREE_MAJOR
#if KERF_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#endif

namespace {

workbench::Solid solid_of(std::int64_t triangles) {
  return triangles == 12 ? workbench::make_box({0, 0, 0}, {1, 2, 3})
                         : workbench::make_torus(static_cast<std::uint32_t>(triangles) / 10, 5);
}

void Kerf(benchmark::State& state) {
  const workbench::Solid solid = solid_of(state.range(0));
  const kerf::BuildOptions options{.threads = static_cast<unsigned>(state.range(1))};
  for (auto _ : state) benchmark::DoNotOptimize(kerf::build(solid.mesh(), options));
}
BENCHMARK(Kerf)
    ->ArgNames({"triangles", "threads"})
    ->ArgsProduct({{12, 100, 1000}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);

// Ten thousand meshes, all of which are kept.
void KerfManyMeshes(benchmark::State& state) {
  const workbench::Solid solid = solid_of(100);
  const kerf::BuildOptions options{.threads = 1};
  for (auto _ : state) {
    std::vector<kerf::Bvh> all(10'000);
    for (kerf::Bvh& bvh : all) bvh = kerf::build(solid.mesh(), options);
    benchmark::DoNotOptimize(all.data());
  }
}
BENCHMARK(KerfManyMeshes)->Unit(benchmark::kMillisecond);

#ifdef KERF_EMBREE_MAJOR
void EmbreeMedium(benchmark::State& state) {
  const workbench::Solid solid = solid_of(state.range(0));
  std::vector<kerf::Vec3f> vertices = solid.vertices;
  vertices.emplace_back();  // Embree reads four floats at a time
  const RTCDevice device = rtcNewDevice("threads=1");
  for (auto _ : state) {
    const RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices.data(), 0,
                               sizeof(kerf::Vec3f), solid.vertices.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, solid.triangles.data(),
                               0, 3 * sizeof(std::uint32_t), solid.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    rtcReleaseScene(scene);
  }
  rtcReleaseDevice(device);
}
BENCHMARK(EmbreeMedium)->ArgName("triangles")->Arg(12)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
#endif

}  // namespace

BENCHMARK_MAIN();
