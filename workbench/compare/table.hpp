// Comparisons as text.
#pragma once

#include <string>

#include "workbench/compare/compare.hpp"
#include "workbench/terminal/table.hpp"

namespace workbench {

/// One scene: a table of its trees and one per ray type. Rows are builders, columns are measures. Each figure
/// is followed by its ratio to that of the first builder.
std::string format_comparison(const SceneFigures& scene, Emphasis emphasis,
                              std::size_t max_width = default_columns);

/// One scene over alpha: cost, references and speed, each with a bar chart beside the figures.
std::string format_sweep(const SceneFigures& scene, Emphasis emphasis,
                         std::size_t max_width = default_columns);

/// One scene over builders and the references that each may make: the same figures.
std::string format_budgets(const SceneFigures& scene, Emphasis emphasis,
                           std::size_t max_width = default_columns);

}  // namespace workbench
