#include "workbench/report/report.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "report_assets.hpp"
#include "workbench/compare/json.hpp"
#include "workbench/compare/measures.hpp"
#include "workbench/render/heat.hpp"
#include "workbench/report/charts.hpp"
#include "workbench/report/html.hpp"
#include "workbench/report/tables.hpp"

namespace workbench {
namespace {

// Nothing may be loaded and no script may run. The browser enforces it.
constexpr std::string_view content_policy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";

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

constexpr std::string_view budgets_lead =
    "Every split of a triangle costs a reference, and memory. How much speed do so many references per "
    "triangle "
    "buy, by spatial splits while the tree is built (<b>sbvh</b>: Stich, Friedrich &amp; Dietrich 2009) and "
    "by "
    "splitting beforehand? A builder whose line lies above another’s makes more of the same memory.";

std::string_view lead(const Report& report) {
  switch (report.kind) {
    case Report::Kind::sweep:
      return sweep_lead;
    case Report::Kind::budgets:
      return budgets_lead;
    default:
      return comparison_lead;
  }
}

std::string page_title(const Report& report) {
  if (report.kind == Report::Kind::sweep) return "What alpha buys";
  if (report.kind == Report::Kind::budgets) return "What references buy";
  return "What the splits bought";
}

std::string head(const Report& report) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n"
      "<title>kerf: {}</title>\n<style>\n{}</style>\n</head>\n",
      content_policy, page_title(report), embedded::report_style());
}

std::string masthead(const Report& report) {
  const Machine& machine = report.machine;
  return fmt::format(
      "<header>\n<p class=\"wordmark\">kerf</p>\n<h1>{}</h1>\n<p class=\"lead\">{}</p>\n"
      "<pre class=\"command\"><code>{}</code></pre>\n"
      "<dl class=\"facts\">\n"
      "<div><dt>Processor</dt><dd>{}, traced with {}</dd></div>\n"
      "<div><dt>Threads</dt><dd>builds {} of {}, rays 1</dd></div>\n"
      "<div><dt>System</dt><dd>{}</dd></div>\n"
      "<div><dt>Versions</dt><dd>kerf {}, {}</dd></div>\n"
      "<div><dt>Made</dt><dd>{}</dd></div>\n"
      "</dl>\n</header>\n",
      page_title(report), lead(report), escape_html(report.command), escape_html(machine.processor),
      escape_html(report.target), report.threads, machine.threads, escape_html(machine.system),
      escape_html(report.version), escape_html(machine.compiler), escape_html(report.date));
}

// The classes of builders' colours: each has one of its own, and so have the qualities of one builder, in the
// order in which they come.
class Styles {
 public:
  std::string of(const std::string& name) {
    for (const std::string_view known : {"bvh", "sbvh", "esc", "evh"}) {
      if (name == known) return name;
    }
    static constexpr std::string_view others[] = {"c2", "c5", "c6"};
    const auto found = std::find(names_.begin(), names_.end(), name);
    const auto place = static_cast<std::size_t>(found - names_.begin());
    if (found == names_.end()) names_.push_back(name);
    return std::string(others[place % std::size(others)]);
  }

 private:
  std::vector<std::string> names_;
};

std::vector<std::string> ray_titles() {
  std::vector<std::string> titles;
  for (const RayType type : ray_types) titles.emplace_back(name(type));
  return titles;
}

double relative(double value, double base) {
  return base > 0.0 ? value / base : 0.0;
}

std::string sweep_charts(const SceneFigures& scene, std::size_t number) {
  std::vector<std::string> alphas;
  for (const BuilderFigures& builder : scene.builders) alphas.push_back(format_alpha(builder.alpha));
  const auto series = [&](std::string title, std::size_t i, const auto& value) {
    ChartSeries line{.name = std::move(title), .style = fmt::format("c{}", i), .values = {}};
    for (const BuilderFigures& builder : scene.builders)
      line.values.push_back(relative(value(builder), value(scene.builders.front())));
    return line;
  };
  Chart cost{.id = fmt::format("cost-{}", number),
             .title = "Cost and references",
             .remark = "relative to the first α",
             .x_title = "α, the overlap from which a spatial split is tried",
             .y_title = "relative",
             .places = alphas,
             .series = {}};
  cost.series.push_back(series("SAH cost", 0, [](const BuilderFigures& b) { return b.sah; }));
  cost.series.push_back(
      series("references", 1, [](const BuilderFigures& b) { return static_cast<double>(b.references); }));
  Chart speed = cost;
  speed.id = fmt::format("speed-{}", number);
  speed.title = "Rays per second";
  speed.series.clear();
  for (std::size_t type = 0; type < std::size(ray_types); ++type) {
    speed.series.push_back(series(ray_titles()[type], type,
                                  [type](const BuilderFigures& b) { return b.rays[type].mrays_per_s; }));
  }
  return html_lines(cost) + html_lines(speed);
}

// A line for each builder, over the budgets.
std::string budget_charts(const SceneFigures& scene, std::size_t number) {
  Chart speed{.id = fmt::format("frontier-{}", number),
              .title = "Rays per second",
              .remark = "of all types together",
              .x_title = "references that a build may make, per triangle",
              .y_title = "Mrays/s",
              .places = {},
              .series = {}};
  Chart references = speed;
  references.id = fmt::format("references-{}", number);
  references.title = "References";
  references.remark = "that are left in the tree";
  references.y_title = "per triangle";
  Styles styles;
  for (const BuilderFigures& builder : scene.builders) {
    const std::string place = fmt::format("{}", builder.budget);
    if (std::find(speed.places.begin(), speed.places.end(), place) == speed.places.end()) {
      speed.places.push_back(place);
      references.places.push_back(place);
    }
    if (speed.series.empty() || speed.series.back().name != builder.name) {
      const ChartSeries line{.name = builder.name, .style = styles.of(builder.name), .values = {}};
      speed.series.push_back(line);
      references.series.push_back(line);
    }
    speed.series.back().values.push_back(
        1e-6 * rays_per_second(builder, {RayType::primary, RayType::ao, RayType::diffuse}));
    references.series.back().values.push_back(
        relative(static_cast<double>(builder.references), static_cast<double>(scene.triangles)));
  }
  return html_lines(speed) + html_lines(references);
}

std::string comparison_charts(const SceneFigures& scene, std::size_t number) {
  Chart trees{.id = fmt::format("trees-{}", number),
              .title = fmt::format("Trees, relative to {}", scene.builders.front().name),
              .remark = "lower is better",
              .x_title = "measure of the tree",
              .y_title = "relative",
              .places = {},
              .series = {}};
  Chart work{.id = fmt::format("work-{}", number),
             .title = "Work per ray",
             .remark = "steps, and triangle tests in the lighter colour on top; lower is better",
             .x_title = "rays",
             .y_title = "steps + tests per ray",
             .places = ray_titles(),
             .series = {}};
  Chart speed{.id = fmt::format("speed-{}", number),
              .title = "Speed",
              .remark = "the line leads to the middle one of the rounds; higher is better",
              .x_title = "rays",
              .y_title = "million rays per second",
              .places = ray_titles(),
              .series = {}};
  constexpr std::string_view shown[] = {"sah", "epo", "lcv", "references", "nodes"};
  for (const auto& measure : tree_measures()) {
    if (std::find(std::begin(shown), std::end(shown), measure.key) == std::end(shown)) continue;
    trees.places.emplace_back(measure.title);
  }
  Styles styles;
  for (const BuilderFigures& builder : scene.builders) {
    ChartSeries tree{.name = builder.name, .style = styles.of(builder.name), .values = {}}, steps = tree,
                                                                                            mrays = tree;
    for (const auto& measure : tree_measures()) {
      if (std::find(std::begin(shown), std::end(shown), measure.key) == std::end(shown)) continue;
      tree.values.push_back(relative(measure.value(builder), measure.value(scene.builders.front())));
    }
    for (const RayFigures& rays : builder.rays) {
      steps.values.push_back(rays.steps);
      steps.above.push_back(rays.triangle_tests);
      mrays.values.push_back(rays.mrays_per_s);
      mrays.whiskers.push_back(rays.median_mrays_per_s);
    }
    trees.series.push_back(std::move(tree));
    work.series.push_back(std::move(steps));
    speed.series.push_back(std::move(mrays));
  }
  return html_bars(trees) + html_bars(work) + html_bars(speed);
}

std::string charts(const Report& report, std::size_t i) {
  const SceneFigures& scene = report.scenes[i].figures;
  const std::string all = report.kind == Report::Kind::sweep     ? sweep_charts(scene, i)
                          : report.kind == Report::Kind::budgets ? budget_charts(scene, i)
                                                                 : comparison_charts(scene, i);
  return fmt::format("<div class=\"charts\">\n{}</div>\n", all);
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

std::string picture(const std::vector<std::uint8_t>& png, std::string_view kind, std::string_view what) {
  return fmt::format("<img class=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">\n", kind,
                     escape_html(what), base64(png));
}

// The pictures of the scene itself are alike through every hierarchy, and one stands for all. Others show an
// error of a hierarchy, beside its heat view.
std::string gallery(const Report& report, const ReportScene& scene) {
  std::string figures;
  for (std::size_t i = 0; i < scene.pictures.size(); ++i) {
    const BuilderFigures& builder = scene.figures.builders[i];
    const RayFigures& primary = builder.rays[0];
    const std::string label = report.kind == Report::Kind::sweep     ? "α = " + format_alpha(builder.alpha)
                              : report.kind == Report::Kind::budgets ? name_with_budget(builder)
                                                                     : builder.name;
    const bool is_new = i == 0 || scene.pictures[i].shaded != scene.pictures[0].shaded;
    if (is_new) {
      figures += fmt::format(
          "<figure>\n{}<figcaption><b>{}</b> <span>{}</span></figcaption></figure>\n",
          picture(scene.pictures[i].shaded, "shaded",
                  fmt::format("{} from its first viewpoint", scene.figures.name)),
          i == 0 ? "the scene" : escape_html(label),
          i == 0 ? "from its first viewpoint, the same pixels through every tree" : "SHOWS OTHER PIXELS");
    }
    figures += fmt::format(
        "<figure>\n{}<figcaption><b>{}</b> <span>{:.1f} steps + {:.1f} tests per primary ray, mean of all "
        "viewpoints</span></figcaption></figure>\n",
        picture(
            scene.pictures[i].heat, "heat",
            fmt::format("Heat view of {}, {}: brighter where a ray costs more", scene.figures.name, label)),
        escape_html(label), primary.steps, primary.triangle_tests);
  }
  return "<div class=\"gallery\">\n" + figures + "</div>\n" + legend(scene.heat_scale);
}

// What the settings in a scene's name do.
std::string setting(const std::string& scene) {
  const std::size_t at = scene.find("rotate=");
  if (at == std::string::npos || scene.find(':') == std::string::npos) return "";
  const std::string degrees = scene.substr(at + 7, scene.find(',', at) - at - 7);
  return fmt::format(
      " Turned by {} degrees about z, then y, then x, after which no wall is parallel to an axis and every "
      "box is "
      "loose: what spatial splits are for.",
      escape_html(degrees));
}

std::string section(const Report& report, std::size_t i) {
  const ReportScene& scene = report.scenes[i];
  const SceneFigures& figures = scene.figures;
  std::string facts = format_count(figures.triangles, "triangle", "triangles");
  if (figures.degenerate_triangles != 0) {
    facts += fmt::format(", {} of them degenerate and left out", format_count(figures.degenerate_triangles));
  }
  std::string text =
      fmt::format("<section id=\"scene-{}\">\n<h2>{}</h2>\n<p class=\"facts-line\">{}. {}{}</p>\n", i,
                  escape_html(figures.name), facts, html_agreement(figures), setting(figures.name));
  if (!figures.remark.empty())
    text += fmt::format("<p class=\"facts-line\">Note: {}.</p>\n", escape_html(figures.remark));
  if (report.kind == Report::Kind::sweep) {
    text += charts(report, i) + html_sweep_table(figures) + gallery(report, scene);
  } else if (report.kind == Report::Kind::budgets) {
    text += charts(report, i) + html_budget_table(figures) + gallery(report, scene);
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
  text +=
      "</main>\n<script type=\"application/json\" id=\"figures\">" +
      escape_script(
          to_json(figures, report.version).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) +
      "</script>\n";
  return text + "</body>\n</html>\n";
}

}  // namespace workbench
