// The time to read scene files, and the memory beside that of the mesh that comes of it.
//
//     build/release/bin/read_bench FILE... [--benchmark_...]

#include <cstdio>
#include <string>

#include <benchmark/benchmark.h>
#include <kerf/error.hpp>

#include "workbench/formats/load_file.hpp"

namespace {

// The most memory that this process has had since it was last asked to forget it, in bytes; 0 where the
// system does not tell.
double peak_bytes() {
  std::FILE* const status = std::fopen("/proc/self/status", "r");
  if (status == nullptr) return 0.0;
  char line[256];
  double kilobytes = 0.0;
  while (std::fgets(line, sizeof line, status) != nullptr) std::sscanf(line, "VmHWM: %lf", &kilobytes);
  std::fclose(status);
  return 1024.0 * kilobytes;
}
void forget_peak() {
  if (std::FILE* const file = std::fopen("/proc/self/clear_refs", "w")) {
    std::fputs("5", file);
    std::fclose(file);
  }
}

void read(benchmark::State& state, const std::string& file) {
  std::size_t triangles = 0, bytes = 0;
  forget_peak();
  const double before = peak_bytes();
  for (auto _ : state) {
    const workbench::Scene scene = workbench::load_file(file);
    triangles = scene.triangles.size();
    bytes = scene.vertices.size() * sizeof(kerf::Vec3f) + triangles * sizeof(scene.triangles[0]);
  }
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["peak/mesh"] = (peak_bytes() - before) / static_cast<double>(bytes);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string file = argv[i];
      workbench::load_file(file);  // an error shows before anything is measured
      benchmark::RegisterBenchmark(file.c_str(), [file](benchmark::State& state) { read(state, file); })
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    }
    benchmark::RunSpecifiedBenchmarks();
  } catch (const kerf::Error& error) {
    std::fprintf(stderr, "read_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
