#include "workbench/report/report.hpp"

#include <fmt/format.h>

#include "report_assets.hpp"
#include "workbench/compare/json.hpp"
#include "workbench/compare/measures.hpp"
#include "workbench/render/heat.hpp"
#include "workbench/report/html.hpp"
#include "workbench/report/tables.hpp"

namespace workbench {
namespace {

// Nothing may be loaded. The browser enforces it.
constexpr std::string_view content_policy =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

// Counts errors from the start, for the test that opens the page.
constexpr std::string_view error_counter = R"(
  document.documentElement.dataset.errors = 0;
  addEventListener('error', () => { document.documentElement.dataset.errors++; }, true);
  addEventListener('securitypolicyviolation', () => { document.documentElement.dataset.errors++; });
  addEventListener('unhandledrejection', () => { document.documentElement.dataset.errors++; });
)";

constexpr std::string_view comparison_lead =
    "Bounding volume hierarchies with spatial splits (<b>sbvh</b>: Stich, Friedrich &amp; Dietrich 2009) "
    "beside plain object splits (<b>bvh</b>) and two ways of splitting triangles beforehand, with the same "
    "number of references: early split clipping (<b>esc</b>: Ernst &amp; Greiner 2007) and the edge volume "
    "heuristic (<b>evh</b>: Dammertz &amp; Keller 2008). All traced the same rays in the same run, "
    "interleaved.";

constexpr std::string_view sweep_lead =
    "A spatial split is tried where the children of the best object split overlap by more than <i>α</i> of "
    "the "
    "root’s surface. From <i>α</i>&nbsp;=&nbsp;1, the plain BVH, down to 0, where one is always tried: cost, "
    "references and speed.";

std::string page_title(const Report& report) {
  if (report.kind == Report::Kind::sweep) return "What alpha buys";
  return "What the splits bought";
}

std::string head(const Report& report) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n"
      "<title>kerf: {}</title>\n<script>{}</script>\n<style>\n{}</style>\n</head>\n",
      content_policy, page_title(report), error_counter, embedded::report_style());
}

std::string masthead(const Report& report) {
  const Machine& machine = report.machine;
  return fmt::format(
      "<header>\n<p class=\"wordmark\">kerf</p>\n<h1>{}</h1>\n<p class=\"lead\">{}</p>\n"
      "<pre class=\"command\"><code>{}</code></pre>\n"
      "<dl class=\"facts\">\n"
      "<div><dt>Processor</dt><dd>{}</dd></div>\n"
      "<div><dt>Threads</dt><dd>builds {} of {}, rays 1</dd></div>\n"
      "<div><dt>System</dt><dd>{}</dd></div>\n"
      "<div><dt>Versions</dt><dd>kerf {}, {}</dd></div>\n"
      "<div><dt>Made</dt><dd>{}</dd></div>\n"
      "</dl>\n</header>\n",
      page_title(report), report.kind == Report::Kind::sweep ? sweep_lead : comparison_lead,
      escape_html(report.command), escape_html(machine.processor), report.threads, machine.threads,
      escape_html(machine.system), escape_html(report.version), escape_html(machine.compiler),
      escape_html(report.date));
}

std::string chart(std::string_view kind, std::size_t scene, std::string_view caption) {
  return fmt::format(
      "<figure class=\"chart\"><figcaption>{}</figcaption>\n"
      "<div><canvas data-chart=\"{}\" data-scene=\"{}\" role=\"img\"></canvas></div></figure>\n",
      caption, kind, scene);
}

std::string charts(const Report& report, std::size_t scene) {
  if (report.kind == Report::Kind::sweep) {
    return "<div class=\"charts\">\n" +
           chart("sweep-cost", scene, "Cost and references, relative to the first α") +
           chart("sweep-speed", scene, "Rays per second, relative to the first α") + "</div>\n";
  }
  return "<div class=\"charts\">\n" +
         chart("tree", scene,
               fmt::format("Trees, relative to {} <small>lower is better</small>",
                           escape_html(report.scenes[scene].figures.builders[0].name))) +
         chart("work", scene,
               "Steps (solid) and triangle tests (light) per ray <small>lower is better</small>") +
         chart("speed", scene, "Million rays per second <small>higher is better</small>") + "</div>\n";
}

// The bar of colours under the heat views, with its numbers.
std::string legend(float scale) {
  constexpr int stops = 32, ticks = 4;
  std::string gradient, numbers;
  for (int i = 0; i <= stops; ++i) {
    const auto [r, g, b] = heat_colour(static_cast<float>(i) / stops);
    gradient += fmt::format(", rgb({} {} {})", r, g, b);
  }
  for (int i = 0; i <= ticks; ++i) {
    numbers +=
        fmt::format("<span>{:.4g}{}</span>", scale * static_cast<float>(i) / ticks, i == ticks ? "+" : "");
  }
  return fmt::format(
      "<div class=\"legend\">\n<p>Steps plus triangle tests of the primary ray through each pixel</p>\n"
      "<div class=\"scale\" style=\"background: linear-gradient(to right{})\"></div>\n"
      "<div class=\"ticks\">{}</div>\n</div>\n",
      gradient, numbers);
}

std::string picture(const std::vector<std::uint8_t>& png, std::string_view kind, std::string_view builder,
                    std::string_view scene) {
  return fmt::format("<img class=\"{0}\" alt=\"{1}, {2}: {0}\" src=\"data:image/png;base64,{3}\">\n", kind,
                     escape_html(scene), escape_html(builder), base64(png));
}

std::string gallery(const Report& report, const ReportScene& scene) {
  std::string figures;
  for (std::size_t i = 0; i < scene.pictures.size(); ++i) {
    const BuilderFigures& builder = scene.figures.builders[i];
    const RayFigures& primary = builder.rays[0];
    const std::string label =
        report.kind == Report::Kind::sweep ? "α = " + format_alpha(builder.alpha) : builder.name;
    figures += fmt::format(
        "<figure>\n{}{}<figcaption><b>{}</b> <span>{:.1f} steps + {:.1f} tests per primary ray, mean of all "
        "viewpoints</span></figcaption></figure>\n",
        picture(scene.pictures[i].heat, "heat", label, scene.figures.name),
        picture(scene.pictures[i].shaded, "shaded", label, scene.figures.name), escape_html(label),
        primary.steps, primary.triangle_tests);
  }
  return "<div class=\"gallery\">\n" + figures + "</div>\n" + legend(scene.heat_scale);
}

std::string section(const Report& report, std::size_t i) {
  const ReportScene& scene = report.scenes[i];
  const SceneFigures& figures = scene.figures;
  std::string facts = format_count(figures.triangles) + " triangles";
  if (figures.degenerate_triangles != 0) {
    facts += fmt::format(", {} of them degenerate and left out", format_count(figures.degenerate_triangles));
  }
  std::string text =
      fmt::format("<section id=\"scene-{}\">\n<h2>{}</h2>\n<p class=\"facts-line\">{}. {}</p>\n", i,
                  escape_html(figures.name), facts, html_agreement(figures));
  if (report.kind == Report::Kind::sweep) {
    text += charts(report, i) + html_sweep_table(figures) + gallery(report, scene);
  } else {
    text += gallery(report, scene) + charts(report, i) + html_tables(figures);
  }
  return text + "</section>\n";
}

}  // namespace

std::string render_html(const Report& report) {
  std::vector<SceneFigures> figures;
  for (const ReportScene& scene : report.scenes) figures.push_back(scene.figures);

  std::string text = head(report) + "<body>\n<main>\n" + masthead(report);
  if (report.kind == Report::Kind::comparison) text += html_summary(figures);
  for (std::size_t i = 0; i < report.scenes.size(); ++i) text += section(report, i);
  text += html_glossary();
  text += "</main>\n<script type=\"application/json\" id=\"figures\">" +
          escape_script(to_json(figures, report.version).dump()) + "</script>\n";
  text += fmt::format("<script>{}</script>\n<script>{}</script>\n</body>\n</html>\n", embedded::chart_js(),
                      embedded::report_charts());
  return text;
}

}  // namespace workbench
