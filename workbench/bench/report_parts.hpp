// What the reports of all benchmarks share.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "workbench/bench/bench.hpp"
#include "workbench/bench/report.hpp"
#include "workbench/terminal/table.hpp"

namespace workbench {

/// In place of a figure that there is none of.
inline constexpr const char* no_figure = "-";

/// Marks the cell with the best value: the largest, or the smallest.
void mark_best(Column& column, const std::vector<std::optional<double>>& values, bool largest);

/// A column of `figure(result)`, with the best one marked.
template <class Result, class Figure>
Column figures(const std::vector<Result>& results, std::string head, const char* format, bool largest,
               const Figure& figure) {
  Column column{.head = std::move(head), .cells = {}};
  std::vector<std::optional<double>> values;
  for (const Result& result : results) {
    const std::optional<double> value = values.emplace_back(figure(result));
    column.cells.push_back({value ? fmt::format(fmt::runtime(format), *value) : no_figure});
  }
  mark_best(column, values, largest);
  return column;
}

/// The speed of rays of one type, with digits that tell apart also the slow ones.
template <class Result>
Column speeds(const std::vector<Result>& results, RayType type) {
  const auto speed = [type](const Result& result) {
    return result.rays[static_cast<std::size_t>(type)].speed();
  };
  const bool slow = std::any_of(results.begin(), results.end(),
                                [&](const Result& result) { return speed(result).value_or(1.0) < 0.1; });
  return figures(results, fmt::format("{} Mrays/s", name(type)), slow ? "{:.3g}" : "{:.2f}", true, speed);
}

/// A column of `text(result)`.
template <class Result, class Text>
Column names(const std::vector<Result>& results, std::string head, const Text& text) {
  Column column{.head = std::move(head), .cells = {}, .left_aligned = true};
  for (const Result& result : results) column.cells.push_back({std::string(text(result))});
  return column;
}

/// `{"primary": {"count": 1, "hits": 1, "mrays_per_s": 1.0}, ...}`; the speed of rays that hit nothing is
/// null.
nlohmann::ordered_json rays_json(std::span<const BenchRays> rays);

/// The figures of all scenes behind what holds for all of them.
nlohmann::ordered_json scenes_json(const BenchRun& run, nlohmann::ordered_json scenes);

}  // namespace workbench
