// What was found of meshes that bend, for people and for programs.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "workbench/bench/bench.hpp"
#include "workbench/bench/report.hpp"
#include "workbench/terminal/table.hpp"

namespace workbench {

/// As `to_json` of `BenchScene`s; each scene has `motion`, the part of the extent by which it bends, and each
/// result `motion`, "refit" or "rebuild", and `frame_ms`.
nlohmann::ordered_json to_json(std::span<const MotionScene> scenes, const BenchRun& run);

/// One table per scene.
std::string format_motion(std::span<const MotionScene> scenes, Emphasis emphasis,
                          std::size_t max_width = default_columns);

}  // namespace workbench
