#include <memory>

#include <fmt/format.h>

#include "arguments.hpp"
#include "commands.hpp"
#include "measure.hpp"
#include "workbench/compare/measures.hpp"
#include "workbench/compare/table.hpp"

namespace kerf_tool {
namespace {

struct Options {
  std::string scene;
  std::string alphas = "1,1e-1,1e-2,1e-3,1e-4,1e-5,1e-6,1e-7,0";
  MeasureOptions measuring;
};

void run(const Options& options, const std::string& command_line) {
  Measurement measurement{.specs = {options.scene},
                          .contenders = {},
                          .options = options.measuring,
                          .kind = workbench::Report::Kind::sweep,
                          .command_line = command_line,
                          .format_table = workbench::format_sweep};
  for (const float alpha : parse_alphas("--alphas", options.alphas)) {
    measurement.contenders.push_back(
        {.name = "sbvh", .options = {.builder = kerf::Builder::sbvh, .alpha = alpha}});
  }
  measure_and_write(measurement);
}

}  // namespace

void add_sweep_command(CLI::App& app, const std::string& command_line) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("sweep", "Cost, references and speed as a function of alpha");
  command->add_option("SCENE", options->scene, scene_help)->type_name("")->required();
  command->add_option("--alphas", options->alphas, "Values from 0 to 1, separated by commas")
      ->type_name("LIST")
      ->capture_default_str();
  add_options(*command, options->measuring);
  command->callback([options, command_line] { run(*options, command_line); });
}

}  // namespace kerf_tool
