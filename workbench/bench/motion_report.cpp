#include "workbench/bench/motion_report.hpp"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "workbench/bench/report_parts.hpp"

namespace workbench {
namespace {

std::string format_scene(const MotionScene& scene, Emphasis emphasis, std::size_t max_width) {
  const auto& results = scene.results;
  std::vector<Column> columns{
      names(results, "engine", [](const MotionResult& r) { return r.engine; }),
      names(results, "isa", [](const MotionResult& r) { return r.isa; }),
      names(results, "rays", [&](const MotionResult&) { return name(scene.rays_made); }),
      names(results, "motion", [](const MotionResult& r) { return r.motion; }),
      figures(results, "frame ms", "{:.2f}", false, [](const MotionResult& r) { return r.frame_ms; }),
  };
  for (const RayType type : ray_types) columns.push_back(speeds(results, type));
  std::string text =
      fold_text(fmt::format("{}: {}, bent by up to {:g} % of the extent", scene.name,
                            format_count(scene.triangles, "triangle", "triangles"), 100.0 * scene.amount),
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
      results.push_back({{"engine", result.engine},
                         {"mode", "single"},
                         {"isa", result.isa},
                         {"rays_made", name(scene.rays_made)},
                         {"motion", result.motion},
                         {"frame_ms", result.frame_ms},
                         {"rays", rays_json(result.rays)}});
    }
    list.push_back({{"name", scene.name},
                    {"triangles", scene.triangles},
                    {"motion", scene.amount},
                    {"results", std::move(results)}});
    if (!scene.remarks.empty()) list.back()["remarks"] = scene.remarks;
  }
  return scenes_json(run, std::move(list));
}

}  // namespace workbench
