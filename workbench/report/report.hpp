// A comparison as a web page that needs no network and no other file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "workbench/compare/compare.hpp"
#include "workbench/report/machine.hpp"

namespace workbench {

/// The pictures of a scene that were traced through one hierarchy, as PNG files.
struct Pictures {
  std::vector<std::uint8_t> shaded;
  std::vector<std::uint8_t> heat;  ///< on the scale of the scene
};

struct ReportScene {
  SceneFigures figures;
  std::vector<Pictures> pictures = {};  ///< one per builder, or none
  float heat_scale = 1.0f;              ///< steps plus triangle tests at the end of the colours
};

struct Report {
  enum class Kind {
    comparison,  ///< of builders
    sweep,       ///< of one builder over alpha
    budgets,     ///< of builders over the references that they may make
  };
  Kind kind = Kind::comparison;
  std::vector<ReportScene> scenes;
  std::string command;  ///< that made it
  std::string version;  ///< of kerf
  std::string date;
  unsigned threads = 1;  ///< that built
  std::string target;    ///< the instruction set that traced
  Machine machine;
};

/// The page. It loads nothing and runs no script; its figures are in it as JSON, too.
std::string render_html(const Report& report);

/// Renders the scene from its first viewpoint through every hierarchy. The heat views share one scale.
ReportScene make_report_scene(const Scene& scene, const Comparison& comparison, std::size_t width,
                              std::size_t height);

}  // namespace workbench
