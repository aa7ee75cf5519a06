// Rays and queries on a GPU: answers compared with the library's, then timed.
//
//     kerf_cuda_bench [--no-peers] [--objects] [--no-queries] [--small] [--once] [roofline] [aimed COUNT]
//     [build SCENE] SCENE...
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>

#include <cuda_runtime_api.h>

#include "aimed_bench.hpp"
#include "report.hpp"
#include "roofline.hpp"
#include "scene_bench.hpp"

namespace kerf::cuda {
namespace {

int run(int argc, char** argv) {
  cudaDeviceProp properties;
  int driver = 0, runtime = 0;
  check(cudaGetDeviceProperties(&properties, 0), "asking for the device");
  check(cudaDriverGetVersion(&driver), "asking for the driver");
  check(cudaRuntimeGetVersion(&runtime), "asking for the runtime");
  say("%s, %d multiprocessors, %.1f GB, L2 %.0f MB; CUDA of the driver %d, of the runtime %d",
      properties.name, properties.multiProcessorCount, 1e-9 * static_cast<double>(properties.totalGlobalMem),
      1e-6 * properties.l2CacheSize, driver, runtime);
  SceneBenchOptions options;
  bool good = true;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--no-peers") {
      options.peers = false;
    } else if (word == "--objects") {
      options.presplit_builders = false;
    } else if (word == "--no-queries") {
      options.queries = false;
    } else if (word == "--small") {
      options.width = 64;
      options.height = 48;
      options.rounds = 1;
    } else if (word == "--once") {
      options.rounds = 0;
    } else if (word == "roofline") {
      const Roofline roofline = measure_roofline();
      std::printf("ROOFLINE copy %.0f GB/s; fused multiply-add %.1f TFLOP/s; minima %.2f T/s\n",
                  roofline.copy_gb_per_s, roofline.fma_tflops, roofline.minimum_tops);
    } else if (word == "aimed" && i + 1 < argc) {
      good &= bench_aimed_rays(std::stoull(argv[++i]));
    } else if (word == "build" && i + 1 < argc) {
      build_scene(argv[++i]);
    } else {
      good &= bench_scene(std::string(word), options);
    }
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace kerf::cuda

int main(int argc, char** argv) {
  try {
    return kerf::cuda::run(argc, argv);
  } catch (const std::exception& error) {
    std::printf("FAILED: %s\n", error.what());
    return 2;
  }
}
