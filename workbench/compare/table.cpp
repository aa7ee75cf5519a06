#include "workbench/compare/table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "workbench/compare/measures.hpp"

namespace workbench {
namespace {

constexpr double bar_width = 12.0;

std::string heading(const SceneFigures& scene, std::size_t max_width) {
  std::string text =
      fmt::format("{}: {}", scene.name, format_count(scene.triangles, "triangle", "triangles"));
  if (scene.degenerate_triangles != 0) {
    text += fmt::format(", {} of them degenerate and left out", format_count(scene.degenerate_triangles));
  }
  if (!scene.device.empty()) text += fmt::format("; traced by {}", scene.device);
  text = fold_text(text, max_width);
  return scene.remark.empty() ? text : text + fold_text("Note: " + scene.remark + ".", max_width);
}

// What a row is called.
std::string label(const BuilderFigures& builder) {
  return builder.structure.empty() ? builder.name : builder.name + " " + builder.structure;
}

// A column of figures, the best of them marked, and a column of their ratios to the first.
void append_measured(std::vector<Column>& columns, std::string_view head, const std::vector<double>& values,
                     bool higher_is_better, std::string (*format)(double)) {
  const std::vector<bool> best = best_of(values, higher_is_better);
  Column figures{.head = std::string(head), .cells = {}, .gap = "   "};
  Column ratios{.head = "", .cells = {}, .gap = " "};
  for (std::size_t i = 0; i < values.size(); ++i) {
    figures.cells.push_back({format(values[i]), best[i]});
    ratios.cells.push_back({i == 0 ? "" : format_ratio(values[i], values[0])});
  }
  columns.push_back(std::move(figures));
  if (values.size() > 1) columns.push_back(std::move(ratios));
}

// Of the same width in every table of a scene, so that the columns are aligned.
Column name_column(const SceneFigures& scene, std::string_view head) {
  Column column{.head = fmt::format("{:<18}", head), .cells = {}, .left_aligned = true, .gap = "  "};
  for (const BuilderFigures& builder : scene.builders) column.cells.push_back({label(builder)});
  return column;
}

std::string verdict(const SceneFigures& scene) {
  if (scene.builders.size() < 2 && scene.device.empty()) return "";
  const bool here = scene.device.empty();
  if (scene.disagreements() == 0) {
    return fmt::format("  The hits of all agree{}, ray for ray.\n", here ? "" : " with those of the CPU");
  }
  return fmt::format("  {} HITS DIFFER from those of {}.\n", format_count(scene.disagreements()),
                     here ? scene.builders.front().name : "the CPU");
}

// Eighths of a block let bars of twelve characters show differences of one percent.
std::string bar(double fraction) {
  static constexpr std::string_view eighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const auto filled = static_cast<std::size_t>(std::lround(8.0 * bar_width * std::clamp(fraction, 0.0, 1.0)));
  std::string text;
  for (std::size_t i = 0; i < filled / 8; ++i) text += "█";
  return text + std::string(eighths[filled % 8]);
}

void append_bars(std::vector<Column>& columns, const std::vector<double>& values) {
  const double highest = values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  Column column{.head = "", .cells = {}, .left_aligned = true, .gap = " "};
  for (const double value : values) column.cells.push_back({bar(highest > 0.0 ? value / highest : 0.0)});
  columns.push_back(std::move(column));
}

// Cost, references and speed behind a first column that says what was varied.
std::string format_varied(const SceneFigures& scene, Emphasis emphasis, std::size_t max_width,
                          Column varied) {
  std::vector<Column> columns{std::move(varied)};
  const auto append = [&](std::string_view head, bool higher_is_better, std::string (*format)(double),
                          auto&& value) {
    std::vector<double> values;
    for (const BuilderFigures& builder : scene.builders) values.push_back(value(builder));
    append_measured(columns, head, values, higher_is_better, format);
    append_bars(columns, values);
  };
  for (const auto& measure : tree_measures()) {
    if (measure.key == "sah" || measure.key == "references") {
      append(measure.title, measure.higher_is_better, measure.format, measure.value);
    }
  }
  const auto& speed = ray_measures().back();
  append(speed.title, speed.higher_is_better, speed.format, [](const BuilderFigures& builder) {
    return 1e-6 * rays_per_second(builder, {RayType::primary, RayType::ao, RayType::diffuse});
  });
  return heading(scene, max_width) + "\n" + format(columns, emphasis, max_width) + "\n" + verdict(scene);
}

}  // namespace

std::string format_comparison(const SceneFigures& scene, Emphasis emphasis, std::size_t max_width) {
  std::string text = heading(scene, max_width) + "\n";
  std::vector<Column> tree{name_column(scene, "tree")};
  for (const auto& measure : tree_measures()) {
    std::vector<double> values;
    for (const BuilderFigures& builder : scene.builders) values.push_back(measure.value(builder));
    append_measured(tree, measure.title, values, measure.higher_is_better, measure.format);
  }
  text += format(tree, emphasis, max_width);
  for (std::size_t type = 0; type < std::size(ray_types); ++type) {
    std::vector<Column> rays{name_column(scene, title(ray_types[type]))};
    for (const auto& measure : ray_measures()) {
      std::vector<double> values;
      for (const BuilderFigures& builder : scene.builders)
        values.push_back(measure.value(builder.rays[type]));
      append_measured(rays, measure.title, values, measure.higher_is_better, measure.format);
    }
    text += '\n';
    text += format(rays, emphasis, max_width);
  }
  return text + "\n" + verdict(scene);
}

std::string format_sweep(const SceneFigures& scene, Emphasis emphasis, std::size_t max_width) {
  Column alphas{.head = "alpha", .cells = {}};
  for (const BuilderFigures& builder : scene.builders) alphas.cells.push_back({format_alpha(builder.alpha)});
  return format_varied(scene, emphasis, max_width, std::move(alphas));
}

std::string format_budgets(const SceneFigures& scene, Emphasis emphasis, std::size_t max_width) {
  Column names{.head = "budget", .cells = {}, .left_aligned = true};
  for (const BuilderFigures& builder : scene.builders) names.cells.push_back({name_with_budget(builder)});
  return format_varied(scene, emphasis, max_width, std::move(names));
}

}  // namespace workbench
