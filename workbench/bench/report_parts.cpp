#include "workbench/bench/report_parts.hpp"

namespace workbench {

void mark_best(Column& column, const std::vector<std::optional<double>>& values, bool largest) {
  if (values.size() < 2) return;
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!values[i]) continue;
    if (!best || (largest ? *values[i] > *values[*best] : *values[i] < *values[*best])) best = i;
  }
  if (best) column.cells[*best].best = true;
}

nlohmann::ordered_json rays_json(std::span<const BenchRays> rays) {
  nlohmann::ordered_json json;
  for (const BenchRays& r : rays) {
    auto& entry = json[std::string(name(r.type))] = {{"count", r.count}, {"hits", r.hits}};
    const std::optional<double> speed = r.speed();
    entry["mrays_per_s"] = speed ? nlohmann::ordered_json(*speed) : nlohmann::ordered_json();
  }
  return json;
}

nlohmann::ordered_json scenes_json(const BenchRun& run, nlohmann::ordered_json scenes) {
  return {
      {"kerf", run.version}, {"threads", run.threads}, {"target", run.target}, {"scenes", std::move(scenes)}};
}

}  // namespace workbench
