// The one list of what tables, charts and explanations say about each figure.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "workbench/compare/compare.hpp"
#include "workbench/terminal/table.hpp"

namespace workbench {

/// One figure of `Figures`, as a column of a table.
template <class Figures>
struct Measure {
  std::string_view key;      ///< as in the JSON
  std::string_view title;    ///< the column's head
  std::string_view meaning;  ///< one line
  bool higher_is_better;
  double (*value)(const Figures&);
  std::string (*format)(double);  ///< in the unit of the title
};

std::span<const Measure<BuilderFigures>> tree_measures();
std::span<const Measure<RayFigures>> ray_measures();

/// The name of the ray type in full, and what such a ray is.
std::string_view title(RayType type);
std::string_view meaning(RayType type);

/// The number of rays of all `types`, divided by the time that they took together.
double rays_per_second(const BuilderFigures& builder, std::initializer_list<RayType> types);

/// For each value whether it is the best. Where all are equal, none is.
std::vector<bool> best_of(std::span<const double> values, bool higher_is_better);

/// `0.93×`, or nothing if either is 0 and there is no ratio.
std::string format_ratio(double value, double base);

/// 0.5 as `0.5`, one in a hundred thousand as `1e-5`.
std::string format_alpha(float alpha);

/// What a builder is called where several budgets of references are compared: `sbvh 1.5`.
std::string name_with_budget(const BuilderFigures& builder);

}  // namespace workbench
