// What a benchmark found, for people and for programs.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "workbench/bench/bench.hpp"
#include "workbench/terminal/table.hpp"

namespace workbench {

/// `{"kerf": version, "threads": N, "scenes": [...]}`, its keys in a fixed order.
nlohmann::ordered_json to_json(std::span<const BenchScene> scenes, std::string_view version,
                               unsigned threads);

/// A table for each scene, then kerf's speed relative to each peer: its least, and the geometric mean over
/// scenes and types of rays.
std::string format_bench(std::span<const BenchScene> scenes, Emphasis emphasis);

/// kerf in one of its modes, relative to a peer: more than 1 where kerf is faster, or smaller.
struct Ratios {
  std::string mode;  ///< of kerf
  std::string peer;
  double mean = 0.0;   ///< geometric, of Mrays/s over scenes and types of rays
  double least = 0.0;  ///< of the same
  std::string least_scene;
  RayType least_type = RayType::primary;
  double primary_mean = 0.0;  ///< geometric, over scenes
  double build_mean = 0.0;    ///< geometric, of build times over scenes
  double build_least = 0.0;
  double bytes_most = 0.0;       ///< kerf's bytes over the peer's, of the scene where it is largest
  double peak_bytes_most = 0.0;  ///< the same of `build_peak_bytes`
};

/// One entry for each of kerf's modes and each peer; none where there are no peers.
std::vector<Ratios> ratios_to_peers(std::span<const BenchScene> scenes);

}  // namespace workbench
