// Comparisons as JSON, as `kerf compare --json` and `kerf sweep --json` write them.
#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "workbench/compare/compare.hpp"

namespace workbench {

/// `{"kerf": version, "scenes": [...]}`, its keys in a fixed order.
nlohmann::ordered_json to_json(std::span<const SceneFigures> scenes, std::string_view version);

}  // namespace workbench
