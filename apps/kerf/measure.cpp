#include "measure.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <kerf/error.hpp>

#include "arguments.hpp"
#include "output.hpp"
#include "workbench/compare_json.hpp"
#include "workbench/progress.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

std::string today() {
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::now()));
}

}  // namespace

void measure_and_write(const Measurement& measurement) {
  require_writable(measurement.json);
  require_writable_directory(measurement.report);
  const std::vector<Scene> scenes = load_scenes(measurement.specs);
  const bool print_tables = measurement.json != standard_output;
  const Emphasis emphasis = isatty(STDOUT_FILENO) ? Emphasis::bold : Emphasis::mark;

  Report report{.kind = measurement.kind,
                .scenes = {},
                .command = measurement.command_line,
                .version = KERF_VERSION,
                .date = today(),
                .machine = this_machine()};
  report.threads = measurement.threads == 0 ? report.machine.threads : measurement.threads;
  std::vector<SceneFigures> figures;
  ProgressBar bar;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    CompareOptions options{.threads = measurement.threads, .rays = {}, .progress = {}};
    options.progress = [&](double part, std::string_view what) {
      bar.show((static_cast<double>(i) + part) / static_cast<double>(scenes.size()),
               fmt::format("{}: {}", scenes[i].name, what));
    };
    const Comparison comparison =
        name_errors(scenes[i], [&] { return compare(scenes[i], measurement.contenders, options); });
    figures.push_back(comparison.figures);
    if (!measurement.report.empty()) report.scenes.push_back(make_report_scene(scenes[i], comparison));
    bar.clear();
    if (print_tables) {
      if (i != 0) write_output("-", "\n");
      write_output("-", measurement.format_table(comparison.figures, emphasis));
    }
  }

  if (!measurement.json.empty())
    write_output(measurement.json, to_json(figures, KERF_VERSION).dump(2) + "\n");
  if (!measurement.report.empty()) {
    const std::string page = (std::filesystem::path(measurement.report) / "index.html").string();
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
