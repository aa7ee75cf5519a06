#include <fmt/format.h>

#include "commands.hpp"
#include "output.hpp"
#include "workbench/compare/measures.hpp"
#include "workbench/generate/generated_scenes.hpp"
#include "workbench/terminal/table.hpp"
#include "workbench/terminal/terminal.hpp"

namespace kerf_tool {
namespace {

void run() {
  using namespace workbench;
  Column names{.head = "scene", .cells = {}, .left_aligned = true, .gap = ""};
  Column counts{.head = "triangles", .cells = {}};
  Column descriptions{.head = "", .cells = {}, .left_aligned = true};
  for (const GeneratedScene& scene : generated_scenes()) {
    names.cells.push_back({std::string(scene.name)});
    counts.cells.push_back({format_count(scene.generate(1.0).triangles.size())});
    descriptions.cells.push_back({std::string(scene.description)});
  }
  write_output(standard_output, format({names, counts, descriptions}, Emphasis::mark, columns_of(stdout)));
}

}  // namespace

void add_scenes_command(CLI::App& app) {
  app.add_subcommand("scenes", "List the generated scenes")->callback(run);
}

}  // namespace kerf_tool
