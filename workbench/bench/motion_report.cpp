#include "workbench/bench/motion_report.hpp"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace workbench {
namespace {

// The best of `figure` is marked: the largest, or the smallest.
Column column(const MotionScene& scene, std::string head, bool largest,
              const std::function<double(const MotionResult&)>& figure) {
  Column column{.head = std::move(head), .cells = {}};
  std::vector<double> values;
  for (const MotionResult& result : scene.results) {
    values.push_back(figure(result));
    column.cells.push_back({fmt::format("{:.2f}", values.back())});
  }
  if (values.size() > 1) {
    const auto best = largest ? std::max_element(values.begin(), values.end())
                              : std::min_element(values.begin(), values.end());
    column.cells[static_cast<std::size_t>(best - values.begin())].best = true;
  }
  return column;
}

std::string format_scene(const MotionScene& scene, Emphasis emphasis, std::size_t max_width) {
  Column engines{.head = "engine", .cells = {}, .left_aligned = true};
  Column isas{.head = "isa", .cells = {}, .left_aligned = true};
  Column motions{.head = "motion", .cells = {}, .left_aligned = true};
  for (const MotionResult& result : scene.results) {
    engines.cells.push_back({result.engine});
    isas.cells.push_back({result.isa});
    motions.cells.push_back({result.motion});
  }
  std::vector<Column> columns{engines, isas, motions,
                              column(scene, "frame ms", false, [](const auto& r) { return r.frame_ms; })};
  for (std::size_t i = 0; i < std::size(ray_types); ++i) {
    columns.push_back(column(scene, fmt::format("{} Mrays/s", name(ray_types[i])), true,
                             [i](const auto& r) { return r.rays[i].mrays_per_s; }));
  }
  std::string text = fold_text(fmt::format("{}: {} triangles, bent by up to {:g} % of the extent", scene.name,
                                           scene.triangles, 100.0 * scene.amount),
                               max_width) +
                     format(columns, emphasis, max_width);
  for (const std::string& remark : scene.remarks) text += fold_text("Note: " + remark, max_width);
  return text + "\n";
}

}  // namespace

std::string format_motion(std::span<const MotionScene> scenes, Emphasis emphasis, std::size_t max_width) {
  std::string text;
  for (const MotionScene& scene : scenes) text += format_scene(scene, emphasis, max_width);
  return text;
}

nlohmann::ordered_json to_json(std::span<const MotionScene> scenes, const BenchRun& run) {
  auto list = nlohmann::ordered_json::array();
  for (const MotionScene& scene : scenes) {
    auto results = nlohmann::ordered_json::array();
    for (const MotionResult& result : scene.results) {
      nlohmann::ordered_json rays;
      for (const BenchRays& r : result.rays)
        rays[std::string(name(r.type))] = {
            {"count", r.count}, {"hits", r.hits}, {"mrays_per_s", r.mrays_per_s}};
      results.push_back({{"engine", result.engine},
                         {"mode", "single"},
                         {"isa", result.isa},
                         {"motion", result.motion},
                         {"frame_ms", result.frame_ms},
                         {"rays", std::move(rays)}});
    }
    list.push_back({{"name", scene.name},
                    {"triangles", scene.triangles},
                    {"motion", scene.amount},
                    {"results", std::move(results)}});
    if (!scene.remarks.empty()) list.back()["remarks"] = scene.remarks;
  }
  return {
      {"kerf", run.version}, {"threads", run.threads}, {"target", run.target}, {"scenes", std::move(list)}};
}

}  // namespace workbench
