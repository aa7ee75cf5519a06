#include "measure.hpp"

#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <kerf/error.hpp>
#include <kerf/version.hpp>
#include <unistd.h>

#include "arguments.hpp"
#include "device.hpp"
#include "output.hpp"
#include "workbench/compare/json.hpp"
#include "workbench/terminal/progress.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

// Fewer rounds than three measure the disturbances of the machine; more than a thousand improve nothing.
constexpr unsigned min_rounds = 3;
constexpr unsigned max_rounds = 1000;

// Of each viewpoint: a device with thousands of cores is idle with fewer.
constexpr RaySetOptions device_rays{.width = 1024, .height = 768};

// The checked options of a measurement.
struct Plan {
  CompareOptions compare;
  PictureSize pictures{};
  std::string json;
  std::string report;
  bool print_tables = true;
};

Plan check(const MeasureOptions& given, bool on_device) {
  Plan plan;
  if (on_device && !given.report.empty())
    throw CLI::ValidationError("--report", "shows what the CPU traces, which --device excludes");
  plan.json = given.json;
  plan.report = given.report;
  plan.print_tables = given.json != standard_output;
  plan.compare.threads = parse_whole("--threads", given.threads, 0, max_threads);
  if (!given.pixels.empty()) {
    const PictureSize pixels = parse_size("--pixels", given.pixels);
    plan.compare.rays = {.width = pixels.width, .height = pixels.height};
  } else if (on_device) {
    plan.compare.rays = device_rays;
  }
  if (!given.rounds.empty()) {
    plan.compare.rounds = parse_whole("--rounds", given.rounds, min_rounds, max_rounds);
    plan.compare.seconds_per_type = 0.0;
  }
  plan.pictures = parse_size("--pictures", given.pictures);
  require_writable(given.json);
  require_writable_directory(given.report);
  return plan;
}

// Measures scene after scene, and prints the table of each as soon as it is known.
std::vector<ReportScene> measure(const Measurement& measurement, const Plan& plan,
                                 const std::vector<Scene>& scenes) {
  const Emphasis emphasis = isatty(STDOUT_FILENO) ? Emphasis::bold : Emphasis::mark;
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
    write_output(standard_output, measurement.format_table(comparison.figures, emphasis));
  }
  return measured;
}

std::string today() {
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::now()));
}

void write(const Measurement& measurement, const Plan& plan, const std::vector<ReportScene>& measured) {
  if (!plan.json.empty()) {
    std::vector<SceneFigures> figures;
    for (const ReportScene& scene : measured) figures.push_back(scene.figures);
    write_output(plan.json, to_json(figures, KERF_VERSION).dump(2) + "\n");
  }
  if (plan.report.empty()) return;
  Report report{.kind = measurement.kind,
                .scenes = measured,
                .command = measurement.command_line,
                .version = KERF_VERSION,
                .date = today(),
                .machine = this_machine()};
  report.threads = plan.compare.threads == 0 ? report.machine.threads : plan.compare.threads;
  const std::string page = (std::filesystem::path(plan.report) / "index.html").string();
  write_output(page, render_html(report));
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
                  "device 1024x768")
      ->type_name("WxH");
  command
      .add_option("--rounds", options.rounds,
                  "Rounds of timing; if not given, at least three, for a second or more")
      ->type_name("N");
  command.add_option("--json", options.json, "Write all figures as JSON to this file; - is standard output")
      ->type_name("FILE");
  command
      .add_option("--report", options.report,
                  "Write index.html with tables, charts and pictures to this directory")
      ->type_name("DIRECTORY");
  command.add_option("--pictures", options.pictures, "WIDTHxHEIGHT of the report's pictures")
      ->type_name("WxH")
      ->capture_default_str();
}

void measure_and_write(const Measurement& measurement) {
  const std::unique_ptr<TracingDevice> device = open_device(measurement.device);
  Plan plan = check(measurement.options, device != nullptr);
  plan.compare.device = device.get();
  const std::vector<Scene> scenes = load_scenes(measurement.specs);
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
