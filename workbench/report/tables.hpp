// The tables of a report, as HTML.
#pragma once

#include <span>
#include <string>

#include "workbench/compare/compare.hpp"

namespace workbench {

/// All scenes at a glance: the cost and the speed of the SBVH relative to the first builder.
std::string html_summary(std::span<const SceneFigures> scenes);

/// One scene: a table of its trees, and one per type of ray.
std::string html_tables(const SceneFigures& scene);

/// One scene over alpha.
std::string html_sweep_table(const SceneFigures& scene);

/// One scene over builders and the references that each may make.
std::string html_budget_table(const SceneFigures& scene);

/// Whether the hits of all builders agree, as a sentence.
std::string html_agreement(const SceneFigures& scene);

/// Every measure and every type of ray, explained in one line each.
std::string html_glossary();

}  // namespace workbench
