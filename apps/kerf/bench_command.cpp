#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <kerf/build.hpp>
#include <kerf/error.hpp>
#include <kerf/inspect.hpp>
#include <kerf/version.hpp>

#include "arguments.hpp"
#include "commands.hpp"
#include "output.hpp"
#include "run_json.hpp"
#include "workbench/bench/bench.hpp"
#include "workbench/bench/motion_report.hpp"
#include "workbench/bench/peer_isa.hpp"
#include "workbench/bench/peers/embree.hpp"
#include "workbench/bench/peers/kerf_engine.hpp"
#include "workbench/bench/report.hpp"
#include "workbench/report/machine.hpp"
#include "workbench/terminal/progress.hpp"
#include "workbench/terminal/terminal.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

constexpr const char* automatic = "auto";

struct BenchArguments {
  std::vector<std::string> scenes;
  std::string threads = "0";
  std::string peers = "embree";
  std::string rays = "made";
  std::string quality = "fast";
  std::string peer_isa = automatic;
  std::optional<std::string> motion;  // in percent; none for meshes at rest
  std::string json;
  std::string format;
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

// The instruction sets from which Embree's is chosen for each scene; none if there is no peer.
std::vector<std::string> peer_isas(const BenchArguments& arguments) {
  if (arguments.peers != "embree") return {};
  const std::vector<std::string> supported = embree_isas();
  if (supported.empty()) {
    fmt::print(stderr, "kerf: this program was built without Embree, so there is no peer\n");
    return {};
  }
  if (arguments.peer_isa == automatic) return isas_up_to(kerf::instruction_set(), supported);
  if (std::find(supported.begin(), supported.end(), arguments.peer_isa) == supported.end()) {
    throw kerf::Error(kerf::Error::invalid_argument,
                      fmt::format("--peer-isa {}: Embree has {} on this machine", arguments.peer_isa,
                                  fmt::join(supported, ", ")));
  }
  return {arguments.peer_isa};
}

std::vector<RaysMade> rays_made(const std::string& rays) {
  if (rays == "both") return {RaysMade::made, RaysMade::array};
  return {rays == name(RaysMade::array) ? RaysMade::array : RaysMade::made};
}

// kerf, and Embree with the fastest of `isas`, unless there are none.
std::vector<Engine> make_engines(const Scene& scene, const std::vector<std::string>& isas,
                                 const BenchOptions& options) {
  const kerf::BuildOptions build{.quality = options.quality, .threads = options.threads};
  std::vector<Engine> engines{kerf_engine(build, KERF_VERSION)};
  if (isas.empty()) return engines;
  for (Engine& engine : embree_engines(options.threads, fastest_isa(scene, isas, options))) {
    engines.push_back(std::move(engine));
  }
  return engines;
}

void bench(const BenchArguments& arguments) {
  unsigned threads = parse_whole("--threads", arguments.threads, 0, max_threads);
  if (threads == 0) threads = usable_threads();
  const kerf::Quality quality = parse_quality("--quality", arguments.quality);
  if (!arguments.json.empty()) require_writable(arguments.json);
  const bool moves = arguments.motion.has_value();
  const Motion motion{.amount = moves ? 0.01 * parse_number("--motion", *arguments.motion, 0.0, 100.0) : 0.0};
  if (moves && (arguments.limits || arguments.rays == "both"))
    throw kerf::Error(kerf::Error::invalid_argument,
                      fmt::format("--motion goes without {}", arguments.limits ? "--limits" : "--rays both"));
  // The limits are those of one hierarchy, and one mesh bends.
  const Repeats repeats = arguments.limits || moves ? Repeats::flattened : Repeats::kept;
  const std::vector<Scene> scenes = load_scenes(arguments.scenes, arguments.format, repeats);
  const std::vector<std::string> isas = peer_isas(arguments);

  std::string versions;
  std::vector<BenchScene> figures;
  std::vector<MotionScene> moving;
  {
    ProgressBar bar;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      BenchOptions options;
      options.threads = threads;
      options.limits = arguments.limits;
      options.quality = quality;
      options.rays_made = rays_made(arguments.rays);
      options.progress = [&](double fraction, std::string_view what) {
        bar.show((static_cast<double>(i) + fraction) / static_cast<double>(scenes.size()), what);
      };
      name_errors(scenes[i], [&] {
        const std::vector<Engine> engines = make_engines(scenes[i], isas, options);
        versions = join_versions(engines);
        if (moves)
          moving.push_back(bench_motion(scenes[i], engines, options, motion));
        else
          figures.push_back(bench_scene(scenes[i], engines, options));
      });
    }
  }
  const BenchRun run{
      .version = KERF_VERSION, .threads = threads, .target = std::string(kerf::instruction_set())};
  const Machine machine = this_machine();
  if (!arguments.json.empty()) {
    nlohmann::ordered_json json = moves ? to_json(moving, run) : to_json(figures, run);
    json.update(run_json(machine, threads));
    write_output(arguments.json, dump_json(json));
  }
  if (arguments.json == standard_output) return;
  const std::string heading = fmt::format("{}, {} of {} threads of {}, {}", versions, threads,
                                          machine.threads, machine.processor, machine.system);
  const std::size_t columns = columns_of(stdout);
  const std::string tables = moves ? format_motion(moving, output_emphasis(), columns)
                                   : format_bench(figures, output_emphasis(), columns);
  write_output(standard_output, fold_text(heading, columns) + "\n" + tables);
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
  command
      ->add_option(
          "--rays", arguments->rays,
          "Where single rays are: made right before each call, ready in an array, or both, interleaved")
      ->check(CLI::IsMember({"made", "array", "both"}))
      ->capture_default_str();
  command->add_option("--quality", arguments->quality, std::string(quality_names) + ": of kerf's tree")
      ->capture_default_str();
  command
      ->add_option("--peer-isa", arguments->peer_isa,
                   "Embree's instruction set; auto is the fastest of those up to kerf's own, measured")
      ->check(CLI::IsMember({automatic, "sse2", "sse4.2", "avx", "avx2", "avx512"}))
      ->capture_default_str();
  command->add_flag("--limits", arguments->limits,
                    "Measure the time of a step at best, and the fraction of that speed that kerf reaches");
  command
      ->add_option(
          "--motion", arguments->motion,
          "Bend each mesh by up to so many percent of its extent, frame after frame: the time of a frame, "
          "by a refit and by a new build, and rays after it")
      ->type_name("PERCENT");
  command->add_option("--json", arguments->json, "Write the figures to this file; - is standard output")
      ->check(names_a_file())
      ->type_name("FILE");
  add_format_option(*command, arguments->format);
  command->callback([arguments] { bench(*arguments); });
}

}  // namespace kerf_tool
