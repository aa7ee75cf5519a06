// Comparisons as text.
#pragma once

#include <string>

#include "workbench/compare/compare.hpp"
#include "workbench/terminal/table.hpp"

namespace workbench {

/// One scene: a table of its trees and one for each ray type, builders down, measures across. Beside each
/// figure stands its ratio to that of the first builder.
std::string format_comparison(const SceneFigures& scene, Emphasis emphasis);

/// One scene over alpha: cost, references and speed, with a bar chart of each beside the figures.
std::string format_sweep(const SceneFigures& scene, Emphasis emphasis);

}  // namespace workbench
