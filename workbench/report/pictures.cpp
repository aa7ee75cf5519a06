#include "workbench/render/heat.hpp"
#include "workbench/render/image.hpp"
#include "workbench/render/render.hpp"
#include "workbench/report/report.hpp"

namespace workbench {
ReportScene make_report_scene(const Scene& scene, const Comparison& comparison, std::size_t width,
                              std::size_t height) {
  const Viewpoint& viewpoint = scene.viewpoints.front();
  const RenderOptions asked{.width = width, .height = height, .samples = 2, .ambient_samples = 4};
  const RenderOptions options = affordable(comparison.hierarchies.front(), viewpoint, asked);
  std::vector<HeatMap> maps;
  for (const kerf::Bvh& bvh : comparison.hierarchies) {
    maps.push_back(trace_heat(bvh, viewpoint, width, height, options.block));
  }
  ReportScene result{.figures = comparison.figures, .pictures = {}, .heat_scale = common_scale(maps)};
  if (const std::string remark = remark_on(options, asked); !remark.empty())
    result.figures.remark += (result.figures.remark.empty() ? "" : "; ") + remark;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    result.pictures.push_back(
        {.shaded = encode_png(render_shaded(Traced(scene, comparison.hierarchies[i]), viewpoint, options)),
         .heat = encode_png(colour(maps[i], result.heat_scale))});
  }
  return result;
}

}  // namespace workbench
