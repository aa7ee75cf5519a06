// The time to load or map a saved hierarchy, beside the time to build it, with one thread and with all.
//
//     build/release/bin/file_bench SCENE [--benchmark_...]      (the atrium if no scene is named)

#include <cstdio>
#include <filesystem>
#include <optional>

#include <benchmark/benchmark.h>
#include <kerf/kerf.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include "workbench/open/load_scene.hpp"

namespace {

// Repeats `work` with as many threads as the argument of the benchmark says, 0 for all there are.
template <class Work>
void repeat(benchmark::State& state, Work&& work) {
  std::optional<tbb::global_control> held;
  if (state.range(0) != 0) {
    held.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(state.range(0)));
  }
  for (auto _ : state) benchmark::DoNotOptimize(work());
}

void run(const std::string& spec, const std::filesystem::path& file) {
  const workbench::Scene scene = workbench::load_scene(spec);
  kerf::build(scene.mesh()).save(file);
  const auto bench = [](const char* name, auto work) {
    benchmark::RegisterBenchmark(name, [work](benchmark::State& state) { repeat(state, work); })
        ->Arg(1)
        ->Arg(0)
        ->ArgName("threads")
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  };
  bench("Build", [&] { return kerf::build(scene.mesh()); });
  bench("Load", [&] { return kerf::Bvh::load(file); });
  bench("Map", [&] { return kerf::Bvh::map(file); });
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("kerf-file-bench-" + std::to_string(::getpid()) + ".kerf");
  int status = 0;
  try {
    run(argc > 1 ? argv[1] : "atrium:detail=4", file);
  } catch (const kerf::Error& error) {
    std::fprintf(stderr, "file_bench: %s\n", error.what());
    status = 1;
  }
  std::filesystem::remove(file);
  return status;
}
