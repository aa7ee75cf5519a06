// What tables, charts and explanations say about each figure: one list for all of them.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "workbench/compare/compare.hpp"

namespace workbench {

/// One figure of `Figures`: its column.
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

/// The ray type in full, and what such a ray is.
std::string_view title(RayType type);
std::string_view meaning(RayType type);

/// Rays of all `types` together, divided by the time that they took together.
double rays_per_second(const BuilderFigures& builder, std::initializer_list<RayType> types);

/// For each value whether it is the best; none is where all are equal.
std::vector<bool> best_of(std::span<const double> values, bool higher_is_better);

/// `0.93×`; nothing if either is 0, so that no ratio can be had.
std::string format_ratio(double value, double base);

/// 0.5 as `0.5`, one in a hundred thousand as `1e-5`.
std::string format_alpha(float alpha);

/// 1234567 as `1,234,567`.
std::string format_count(std::size_t count);

}  // namespace workbench
