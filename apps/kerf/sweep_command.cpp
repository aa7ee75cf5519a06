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
  std::string budgets;  // empty: alpha is varied
  std::string builders = "sbvh,esc,evh";
  MeasureOptions measuring;
};

void run(const Options& options, const std::string& command_line) {
  Measurement measurement{.specs = {options.scene},
                          .contenders = {},
                          .options = options.measuring,
                          .kind = workbench::Report::Kind::sweep,
                          .command_line = command_line,
                          .format_table = workbench::format_sweep};
  if (options.budgets.empty()) {
    for (const float alpha : parse_alphas("--alphas", options.alphas)) {
      measurement.contenders.push_back(
          {.name = "sbvh", .options = {.builder = kerf::Builder::sbvh, .alpha = alpha}});
    }
  } else {
    measurement.kind = workbench::Report::Kind::budgets;
    measurement.format_table = workbench::format_budgets;
    const std::vector<float> budgets = parse_budgets("--budgets", options.budgets);
    for (const NamedBuild& build : parse_builders("--builders", options.builders)) {
      for (const float budget : budgets) {
        measurement.contenders.push_back({.name = build.name, .options = build.options});
        measurement.contenders.back().options.max_reference_ratio = budget;
      }
    }
  }
  measure_and_write(measurement);
}

}  // namespace

void add_sweep_command(CLI::App& app, const std::string& command_line) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("sweep", "Cost, references and speed as a function of alpha, or of a budget");
  command->add_option("SCENE", options->scene, scene_help)->type_name("")->required();
  CLI::Option* const alphas =
      command->add_option("--alphas", options->alphas, "Values from 0 to 1, separated by commas")
          ->type_name("LIST")
          ->capture_default_str();
  CLI::Option* const budgets =
      command
          ->add_option(
              "--budgets", options->budgets,
              "Vary the references that a build may make instead: per triangle, from 1 to 16, separated "
              "by commas")
          ->type_name("LIST")
          ->excludes(alphas);
  command
      ->add_option("--builders", options->builders,
                   "Which builders, separated by commas, are given each of the --budgets")
      ->type_name("LIST")
      ->needs(budgets)
      ->capture_default_str();
  add_options(*command, options->measuring);
  command->callback([options, command_line] { run(*options, command_line); });
}

}  // namespace kerf_tool
