// What a benchmark found, for people and for programs.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "workbench/bench/bench.hpp"
#include "workbench/terminal/table.hpp"

namespace workbench {

/// What holds for all scenes of a run.
struct BenchRun {
  std::string version;  ///< of kerf
  unsigned threads = 1;
  std::string target;  ///< kerf's instruction set
};

/// `{"kerf": version, "threads": N, "target": "AVX2", "scenes": [...]}`, its keys in a fixed order. The speed
/// of rays that hit nothing is null.
nlohmann::ordered_json to_json(std::span<const BenchScene> scenes, const BenchRun& run);

/// One table per scene, then kerf's speed relative to each peer: the geometric mean over scenes and types of
/// rays, and the minimum.
std::string format_bench(std::span<const BenchScene> scenes, Emphasis emphasis,
                         std::size_t max_width = default_columns);

/// kerf in one of its modes, relative to a peer: with single rays where the peer's are, or where they are
/// made relative to kerf with those in an array, if both were measured. Ratios of speeds are above 1 where
/// kerf is faster, ratios of bytes below 1 where kerf is smaller. 0 where there is nothing to compare: no ray
/// hit anything, or there was nothing to build over.
struct Ratios {
  std::string mode;                      ///< of kerf
  RaysMade rays_made = RaysMade::array;  ///< of kerf
  std::string peer;
  double mean = 0.0;  ///< geometric, of Mrays/s over scenes and types of rays
  double min = 0.0;   ///< of the same
  std::string min_scene;
  RayType min_type = RayType::primary;
  double primary_mean = 0.0;  ///< geometric, over scenes
  double build_mean = 0.0;    ///< geometric, of build times over scenes
  double build_min = 0.0;
  double bytes_max = 0.0;       ///< kerf's bytes divided by the peer's, in the scene where that is largest
  double peak_bytes_max = 0.0;  ///< the same of `build_peak_bytes`
};

/// One entry per mode of kerf and peer; none if there is nothing to compare with.
std::vector<Ratios> ratios_to_peers(std::span<const BenchScene> scenes);

}  // namespace workbench
