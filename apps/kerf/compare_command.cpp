#include <memory>
#include <string>
#include <utility>

#include "arguments.hpp"
#include "commands.hpp"
#include "measure.hpp"
#include "workbench/compare/table.hpp"

namespace kerf_tool {
namespace {

struct Options {
  std::vector<std::string> scenes;
  std::string builders = builder_names(",", ",");
  std::string alpha = "1e-5";
  std::string device = "cpu";
  MeasureOptions measuring;
};

void run(const Options& options, const std::string& command_line) {
  Measurement measurement{.specs = options.scenes,
                          .contenders = {},
                          .options = options.measuring,
                          .command_line = command_line,
                          .device = options.device,
                          .format_table = workbench::format_comparison};
  const float alpha = parse_alpha("--alpha", options.alpha);
  for (NamedBuild& build : parse_builders("--builders", options.builders)) {
    build.options.alpha = alpha;
    measurement.contenders.push_back({.name = std::move(build.name), .options = build.options});
  }
  measure_and_write(measurement);
}

}  // namespace

void add_compare_command(CLI::App& app, const std::string& command_line) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("compare", "Build with several builders and trace the same rays");
  command->add_option("SCENE", options->scenes, scene_help)->type_name("")->required();
  command
      ->add_option("--builders", options->builders,
                   "Which builders, separated by commas; sbvh:best is one with a quality, " +
                       std::string(quality_names))
      ->type_name("LIST")
      ->capture_default_str();
  command->add_option("--alpha", options->alpha, "Overlap above which a spatial split is tried, from 0 to 1")
      ->type_name("A")
      ->capture_default_str();
  command
      ->add_option(
          "--device", options->device,
          "What traces: cpu; binary, the CPU through the builders' own trees, one node at a time, "
          "and through wide ones; or cuda for an NVIDIA GPU, which traces a binary and a wide tree, too")
      ->type_name("DEVICE")
      ->capture_default_str();
  add_options(*command, options->measuring);
  command->callback([options, command_line] { run(*options, command_line); });
}

}  // namespace kerf_tool
