// Comparisons as JSON, as `kerf compare --json` and `kerf sweep --json` write them.
#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "workbench/compare/compare.hpp"

namespace workbench {

/// `{"kerf": version, "scenes": [...]}`, its keys in a fixed order; with `"device"` behind `"kerf"` if a
/// device traced, and then with the `"structure"` of each builder's figures behind its name.
nlohmann::ordered_json to_json(std::span<const SceneFigures> scenes, std::string_view version);

}  // namespace workbench
