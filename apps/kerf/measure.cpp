#include "measure.hpp"

#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <kerf/error.hpp>
#include <unistd.h>

#include "arguments.hpp"
#include "output.hpp"
#include "workbench/compare_json.hpp"
#include "workbench/progress.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

// Fewer rounds of timing than three measure the machine's disturbances, and more than a thousand help nobody.
constexpr unsigned fewest_rounds = 3;
constexpr unsigned most_rounds = 1000;

std::string today() {
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::now()));
}

}  // namespace

void add_options(CLI::App& command, MeasureOptions& options) {
  command.add_option("--threads", options.threads, "Threads that build and trace; 0 is all there are")
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--pixels", options.pixels, "WIDTHxHEIGHT of each viewpoint, one primary ray a pixel")
      ->type_name("WxH")
      ->capture_default_str();
  command
      .add_option("--rounds", options.rounds, "Rounds of timing; else at least three, and a second's worth")
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
  const MeasureOptions& given = measurement.options;
  CompareOptions options{.threads = parse_whole("--threads", given.threads, 0, most_threads)};
  const PictureSize pixels = parse_size("--pixels", given.pixels);
  options.rays = {.width = pixels.width, .height = pixels.height};
  if (!given.rounds.empty()) {
    options.rounds = parse_whole("--rounds", given.rounds, fewest_rounds, most_rounds);
    options.seconds_per_type = 0.0;
  }
  const PictureSize pictures = parse_size("--pictures", given.pictures);
  require_writable(given.json);
  require_writable_directory(given.report);
  const std::vector<Scene> scenes = load_scenes(measurement.specs);
  const bool print_tables = given.json != standard_output;
  const Emphasis emphasis = isatty(STDOUT_FILENO) ? Emphasis::bold : Emphasis::mark;

  Report report{.kind = measurement.kind,
                .scenes = {},
                .command = measurement.command_line,
                .version = KERF_VERSION,
                .date = today(),
                .machine = this_machine()};
  report.threads = options.threads == 0 ? report.machine.threads : options.threads;
  std::vector<SceneFigures> figures;
  ProgressBar bar;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    options.progress = [&](double part, std::string_view what) {
      bar.show((static_cast<double>(i) + part) / static_cast<double>(scenes.size()),
               fmt::format("{}: {}", scenes[i].name, what));
    };
    const Comparison comparison =
        name_errors(scenes[i], [&] { return compare(scenes[i], measurement.contenders, options); });
    figures.push_back(comparison.figures);
    if (!given.report.empty())
      report.scenes.push_back(make_report_scene(scenes[i], comparison, pictures.width, pictures.height));
    bar.clear();
    if (print_tables) {
      if (i != 0) write_output("-", "\n");
      write_output("-", measurement.format_table(comparison.figures, emphasis));
    }
  }

  if (!given.json.empty()) write_output(given.json, to_json(figures, KERF_VERSION).dump(2) + "\n");
  if (!given.report.empty()) {
    const std::string page = (std::filesystem::path(given.report) / "index.html").string();
    write_output(page, render_html(report));
    if (print_tables) write_output("-", fmt::format("\nThe report is {}\n", page));
  }
  for (const SceneFigures& scene : figures) {
    if (scene.disagreements() == 0) continue;
    throw kerf::Error(kerf::Error::bad_format,
                      fmt::format("{}: {} hits differ between the builders, which is a bug", scene.name,
                                  scene.disagreements()));
  }
}

}  // namespace kerf_tool
