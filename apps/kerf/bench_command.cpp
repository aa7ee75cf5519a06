#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <kerf/build.hpp>
#include <unistd.h>

#include "arguments.hpp"
#include "commands.hpp"
#include "output.hpp"
#include "workbench/bench/bench.hpp"
#include "workbench/bench/peers/embree.hpp"
#include "workbench/bench/peers/kerf_engine.hpp"
#include "workbench/bench/report.hpp"
#include "workbench/report/machine.hpp"
#include "workbench/terminal/progress.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

struct BenchArguments {
  std::vector<std::string> scenes;
  std::string threads = "0";
  std::string peers = "embree";
  std::string json;
  bool limits = false;
};

std::string join_versions(const std::vector<Engine>& engines) {
  std::vector<std::string> versions;
  for (const Engine& engine : engines) {
    if (std::find(versions.begin(), versions.end(), engine.version) == versions.end()) {
      versions.push_back(engine.version);
    }
  }
  return fmt::format("{}", fmt::join(versions, " beside "));
}

std::vector<Engine> make_engines(const std::string& peers, unsigned threads) {
  kerf::BuildOptions options;
  options.threads = threads;
  std::vector<Engine> engines{kerf_engine(options, KERF_VERSION)};
  if (peers == "embree") {
    std::vector<Engine> embree = embree_engines(threads);
    if (embree.empty()) {
      fmt::print(stderr, "kerf: this program was built without Embree, so there is no peer\n");
    }
    for (Engine& engine : embree) engines.push_back(std::move(engine));
  }
  return engines;
}

void bench(const BenchArguments& arguments) {
  unsigned threads = parse_whole("--threads", arguments.threads, 0, max_threads);
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  require_writable(arguments.json);
  const std::vector<Scene> scenes = load_scenes(arguments.scenes);
  const std::vector<Engine> engines = make_engines(arguments.peers, threads);

  std::vector<BenchScene> figures;
  {
    ProgressBar bar;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      BenchOptions options;
      options.threads = threads;
      options.limits = arguments.limits;
      options.progress = [&](double fraction, std::string_view what) {
        bar.show((static_cast<double>(i) + fraction) / static_cast<double>(scenes.size()), what);
      };
      figures.push_back(name_errors(scenes[i], [&] { return bench_scene(scenes[i], engines, options); }));
    }
  }
  if (!arguments.json.empty()) {
    write_output(arguments.json, to_json(figures, KERF_VERSION, threads).dump(2) + "\n");
  }
  if (arguments.json == standard_output) return;
  const Machine machine = this_machine();
  write_output("-",
               fmt::format("{}, {} of {} threads of {}, {}\n\n{}", join_versions(engines), threads,
                           machine.threads, machine.processor, machine.system,
                           format_bench(figures, isatty(STDOUT_FILENO) ? Emphasis::bold : Emphasis::mark)));
}

}  // namespace

void add_bench_command(CLI::App& app) {
  const auto arguments = std::make_shared<BenchArguments>();
  CLI::App* command =
      app.add_subcommand("bench", "Build time, memory and speed beside Embree, in the same run");
  command->add_option("scenes", arguments->scenes, scene_help)->required()->type_name("SCENE");
  command->add_option("--threads", arguments->threads, "Threads that build and trace; 0 is all there are")
      ->capture_default_str();
  command->add_option("--peers", arguments->peers, "What kerf is compared with: embree or none")
      ->check(CLI::IsMember({"embree", "none"}))
      ->capture_default_str();
  command->add_flag("--limits", arguments->limits,
                    "Measure the time of a step at best, and the fraction of that speed that kerf reaches");
  command->add_option("--json", arguments->json, "Write the figures to this file; - is standard output")
      ->type_name("FILE");
  command->callback([arguments] { bench(*arguments); });
}

}  // namespace kerf_tool
