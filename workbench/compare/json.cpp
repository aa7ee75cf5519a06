#include "workbench/compare/json.hpp"

#include <fmt/format.h>

namespace workbench {
namespace {

using Json = nlohmann::ordered_json;

// The double with the same shortest decimal form, so that 1e-5f is written as 1e-05 and not as
// 9.999999747378752e-06.
double same_decimal(float value) {
  return std::stod(fmt::format("{}", value));
}

Json to_json(const RayFigures& rays) {
  const auto speed = [&](double mrays_per_s) { return rays.count > 0 ? Json(mrays_per_s) : Json(); };
  return {{"count", rays.count},
          {"hits", rays.hits},
          {"steps", rays.steps},
          {"triangle_tests", rays.triangle_tests},
          {"leaf_visits", rays.leaf_visits},
          {"mrays_per_s", speed(rays.mrays_per_s)},
          {"median_mrays_per_s", speed(rays.median_mrays_per_s)}};
}

Json to_json(const BuilderFigures& builder) {
  Json rays = Json::object();
  for (std::size_t type = 0; type < std::size(ray_types); ++type) {
    rays[std::string(name(ray_types[type]))] = to_json(builder.rays[type]);
  }
  Json json{{"name", builder.name}};
  if (!builder.structure.empty()) json["structure"] = builder.structure;
  json.update(Json{{"alpha", same_decimal(builder.alpha)},
                   {"max_reference_ratio", same_decimal(builder.budget)},
                   {"build_ms", builder.build_ms},
                   {"sah", builder.sah},
                   {"epo", builder.epo},
                   {"epo_standard_error", builder.epo_error},
                   {"lcv", builder.lcv},
                   {"references", builder.references},
                   {"nodes", builder.nodes},
                   {"bytes", builder.bytes},
                   {"disagreements", builder.disagreements},
                   {"rays", std::move(rays)}});
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(std::span<const SceneFigures> scenes, std::string_view version) {
  Json list = Json::array();
  for (const SceneFigures& scene : scenes) {
    Json builders = Json::array();
    for (const BuilderFigures& builder : scene.builders) builders.push_back(to_json(builder));
    list.push_back({{"name", scene.name}, {"triangles", scene.triangles}, {"builders", std::move(builders)}});
    if (!scene.remark.empty()) list.back()["remark"] = scene.remark;
  }
  Json json{{"kerf", version}};
  if (!scenes.empty() && !scenes[0].device.empty()) json["device"] = scenes[0].device;
  json["scenes"] = std::move(list);
  return json;
}

}  // namespace workbench
