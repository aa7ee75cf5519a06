// What `compare` and `sweep` have in common: they measure scenes and write what they measured.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "workbench/compare/compare.hpp"
#include "workbench/report/report.hpp"
#include "workbench/terminal/table.hpp"

namespace kerf_tool {

/// The options that `compare` and `sweep` share, as the user wrote them.
struct MeasureOptions {
  std::string threads = "0";
  std::string pixels;  ///< empty: those of `RaySetOptions`, or on a device enough to fill it
  std::string rounds;  ///< empty: as many as are needed
  std::string pictures = "640x400";
  std::string json;    ///< file, `-` for standard output, or empty for none
  std::string report;  ///< directory, or empty for none
  std::string format;  ///< of the files; empty: their endings say it
};

void add_options(CLI::App& command, MeasureOptions& options);

struct Measurement {
  std::vector<std::string> specs;
  std::vector<workbench::Contender> contenders;
  MeasureOptions options;
  workbench::Report::Kind kind = workbench::Report::Kind::comparison;
  std::string command_line;
  std::string device = "cpu";  ///< that traces: one of `tracing_devices`
  std::string (*format_table)(const workbench::SceneFigures&, workbench::Emphasis,
                              std::size_t max_width) = nullptr;
};

/// Checks that everything can be read and written, then measures, then writes the tables (unless the JSON
/// goes to standard output), the JSON and the report. If hits differ between contenders, throws `kerf::Error`
/// after everything is written.
void measure_and_write(const Measurement& measurement);

}  // namespace kerf_tool
