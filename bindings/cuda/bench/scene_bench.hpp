// One scene: hits compared with the library's, then timed.
#pragma once

#include <cstddef>
#include <string>

namespace kerf::cuda {

struct SceneBenchOptions {
  std::size_t width = 1024, height = 768;  ///< of each viewpoint's picture
  int rounds = 7;
  bool peers = true;
  bool presplit_builders = true;  ///< `esc` and `evh` beside `sbvh` and `bvh`
  bool queries = true;
};

/// Builds once on the device, for profilers.
void build_scene(const std::string& spec);

/// Prints tables; false if an answer is not the library's.
bool bench_scene(const std::string& spec, const SceneBenchOptions& options);

}  // namespace kerf::cuda
