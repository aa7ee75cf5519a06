// What `compare` and `sweep` have in common: measuring scenes, and handing out what was measured.
#pragma once

#include <string>
#include <vector>

#include "workbench/compare.hpp"
#include "workbench/report.hpp"
#include "workbench/table.hpp"

namespace kerf_tool {

struct Measurement {
  std::vector<std::string> specs;
  std::vector<workbench::Contender> contenders;
  unsigned threads = 0;  ///< 0 is all there are
  std::string json;      ///< file, `-` for standard output, or empty for none
  std::string report;    ///< directory, or empty for none
  workbench::Report::Kind kind = workbench::Report::Kind::comparison;
  std::string command_line;
  std::string (*format_table)(const workbench::SceneFigures&, workbench::Emphasis) = nullptr;
};

/// Checks that everything can be read and written, measures, and writes the tables (unless the JSON takes
/// standard output), the JSON and the report. Throws `kerf::Error` if hits differ between contenders, after
/// all is written.
void measure_and_write(const Measurement& measurement);

}  // namespace kerf_tool
