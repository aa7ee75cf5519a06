#include "measure.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <kerf/error.hpp>
#include <kerf/inspect.hpp>
#include <kerf/version.hpp>

#include "arguments.hpp"
#include "device.hpp"
#include "output.hpp"
#include "run_json.hpp"
#include "workbench/compare/json.hpp"
#include "workbench/terminal/progress.hpp"
#include "workbench/terminal/terminal.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

// Fewer rounds than three measure the disturbances of the machine; more than a thousand improve nothing.
constexpr unsigned min_rounds = 3;
constexpr unsigned max_rounds = 1000;

// Of each viewpoint: a GPU with thousands of cores is idle with fewer.
constexpr RaySetOptions gpu_rays{.width = 1024, .height = 768};

// The checked options of a measurement.
struct Plan {
  CompareOptions compare;
  PictureSize pictures{};
  std::string json;
  std::string report;
  bool print_tables = true;
};

Plan check(const MeasureOptions& given, bool on_device, bool on_gpu) {
  Plan plan;
  if (on_device && !given.report.empty())
    throw CLI::ValidationError("--report",
                               "shows what the CPU traces through wide nodes, which --device excludes");
  plan.json = given.json;
  plan.report = given.report;
  plan.print_tables = given.json != standard_output;
  plan.compare.threads = parse_whole("--threads", given.threads, 0, max_threads);
  if (!given.pixels.empty()) {
    const PictureSize pixels = parse_size("--pixels", given.pixels);
    plan.compare.rays = {.width = pixels.width, .height = pixels.height};
    plan.compare.bound_rays = false;
  } else if (on_gpu) {
    plan.compare.rays = gpu_rays;
  }
  if (!given.rounds.empty()) {
    plan.compare.rounds = parse_whole("--rounds", given.rounds, min_rounds, max_rounds);
    plan.compare.seconds_per_type = 0.0;
  }
  plan.pictures = parse_size("--pictures", given.pictures);
  if (!given.json.empty()) require_writable(given.json);
  if (!given.report.empty()) require_writable_directory(given.report);
  return plan;
}

// Measures scene after scene, and prints the table of each as soon as it is known.
std::vector<ReportScene> measure(const Measurement& measurement, const Plan& plan,
                                 const std::vector<Scene>& scenes) {
  const Emphasis emphasis = output_emphasis();
  std::vector<ReportScene> measured;
  ProgressBar bar;
  for (const Scene& scene : scenes) {
    CompareOptions options = plan.compare;
    options.progress = [&](double fraction, std::string_view what) {
      bar.show((static_cast<double>(measured.size()) + fraction) / static_cast<double>(scenes.size()),
               fmt::format("{}: {}", scene.name, what));
    };
    const Comparison comparison =
        name_errors(scene, [&] { return compare(scene, measurement.contenders, options); });
    if (plan.report.empty()) {
      measured.push_back({.figures = comparison.figures});
    } else {
      options.progress(1.0, "pictures");
      measured.push_back(make_report_scene(scene, comparison, plan.pictures.width, plan.pictures.height));
    }
    bar.clear();
    if (!plan.print_tables) continue;
    if (measured.size() > 1) write_output(standard_output, "\n");
    write_output(standard_output, measurement.format_table(comparison.figures, emphasis, columns_of(stdout)));
  }
  return measured;
}

void write(const Measurement& measurement, const Plan& plan, const std::vector<ReportScene>& measured) {
  const Machine machine = this_machine();
  const unsigned threads = plan.compare.threads == 0 ? usable_threads() : plan.compare.threads;
  if (!plan.json.empty()) {
    std::vector<SceneFigures> figures;
    for (const ReportScene& scene : measured) figures.push_back(scene.figures);
    nlohmann::ordered_json json = to_json(figures, KERF_VERSION);
    json.update(run_json(machine, threads));
    write_output(plan.json, dump_json(json));
  }
  if (plan.report.empty()) return;
  const Report report{.kind = measurement.kind,
                      .scenes = measured,
                      .command = measurement.command_line,
                      .version = KERF_VERSION,
                      .date = now(),
                      .threads = threads,
                      .target = std::string(kerf::instruction_set()),
                      .machine = machine};
  const std::string page = (std::filesystem::path(plan.report) / "index.html").string();
  write_in_directory(plan.report, "index.html", render_html(report));
  if (plan.print_tables) write_output(standard_output, fmt::format("\nThe report is {}\n", page));
}

}  // namespace

void add_options(CLI::App& command, MeasureOptions& options) {
  command
      .add_option("--threads", options.threads,
                  "Threads that build; 0 is all there are. Rays are timed on one")
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--pixels", options.pixels,
                  "WIDTHxHEIGHT of each viewpoint, one primary ray per pixel; if not given, 256x192, on a "
                  "GPU 1024x768")
      ->type_name("WxH");
  command
      .add_option("--rounds", options.rounds,
                  "Rounds of timing; if not given, at least three, for a second or more")
      ->type_name("N");
  command.add_option("--json", options.json, "Write all figures as JSON to this file; - is standard output")
      ->check(names_a_file())
      ->type_name("FILE");
  command
      .add_option("--report", options.report,
                  "Write index.html with tables, charts and pictures to this directory")
      ->check(names_a_file())
      ->type_name("DIRECTORY");
  add_format_option(command, options.format);
  command.add_option("--pictures", options.pictures, "WIDTHxHEIGHT of the report's pictures")
      ->type_name("WxH")
      ->capture_default_str();
}

void measure_and_write(const Measurement& measurement) {
  const std::unique_ptr<TracingDevice> device = open_device(measurement.device);
  Plan plan = check(measurement.options, device != nullptr, measurement.device == "cuda");
  plan.compare.device = device.get();
  const std::vector<Scene> scenes = load_scenes(measurement.specs, measurement.options.format);
  const std::vector<ReportScene> measured = measure(measurement, plan, scenes);
  write(measurement, plan, measured);
  for (const ReportScene& scene : measured) {
    if (const std::size_t count = scene.figures.disagreements()) {
      throw kerf::Error(
          kerf::Error::bad_format,
          fmt::format("{}: {} hits differ between the trees, which is a bug", scene.figures.name, count));
    }
  }
}

}  // namespace kerf_tool
