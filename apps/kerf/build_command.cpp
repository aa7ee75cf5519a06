#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "arguments.hpp"
#include "commands.hpp"
#include "output.hpp"
#include "workbench/base/raise.hpp"
#include "workbench/compare/measures.hpp"
#include "workbench/open/load_rays.hpp"
#include "workbench/rays/rays.hpp"
#include "workbench/scene/placed.hpp"
#include "workbench/terminal/progress.hpp"

namespace kerf_tool {
namespace {

// A year: a longer time is a mistake.
constexpr double max_seconds = 365.0 * 24.0 * 3600.0;

// What --rays takes beside the name of a file.
constexpr const char* rays_of_viewpoints = "auto";

struct Options {
  std::string scene;
  std::string output;
  std::string builder = "sbvh";
  std::string quality = "fast";
  std::string seconds;
  std::string rays;
  std::string alpha = "1e-5";
  std::string threads = "0";
  std::string format;
};

// Other commands know a hierarchy by the ending of its name.
void check_output(const std::string& name) {
  if (name == standard_output || std::filesystem::path(name).extension() == ".kerf") return;
  throw CLI::ValidationError(
      "--output",
      fmt::format("must end in .kerf, by which other commands know what it is, or be -, not '{}'", name));
}

// The bytes of a saved hierarchy, which is saved to a file that is gone before this returns.
template <class Hierarchy>
std::string saved_bytes(const Hierarchy& hierarchy) {
  std::string directory = (std::filesystem::temp_directory_path() / "kerf-XXXXXX").string();
  if (::mkdtemp(directory.data()) == nullptr)
    throw kerf::Error(kerf::Error::io, directory + ": cannot be made");
  struct Removed {
    const std::string& directory;
    ~Removed() {
      std::error_code ignored;
      std::filesystem::remove_all(directory, ignored);
    }
  } removed{directory};
  const std::filesystem::path file = std::filesystem::path(directory) / "hierarchy.kerf";
  hierarchy.save(file);
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string describe(const kerf::BvhStatistics& statistics) {
  return fmt::format("{}, {}, {}, built in {:.1f} ms",
                     workbench::format_count(statistics.triangles, "triangle", "triangles"),
                     workbench::format_count(statistics.references, "reference", "references"),
                     workbench::format_count(statistics.bytes, "byte", "bytes"),
                     1e3 * statistics.build_seconds);
}

// Each mesh once, and where it stands.
kerf::Scene build_places(const workbench::PlacedMeshes& placed, const kerf::BuildOptions& options,
                         std::string& description) {
  kerf::BvhStatistics sum;
  std::vector<kerf::Bvh> objects;
  for (const workbench::PlacedMeshes::Mesh& mesh : placed.meshes) {
    objects.push_back(kerf::build(mesh.mesh(), options));
    const kerf::BvhStatistics& of_one = objects.back().statistics();
    sum.triangles += of_one.triangles;
    sum.references += of_one.references;
    sum.bytes += of_one.bytes;
    sum.build_seconds += of_one.build_seconds;
  }
  description =
      fmt::format("{} of {}, {}", workbench::format_count(placed.places.size(), "instance", "instances"),
                  workbench::format_count(placed.meshes.size(), "mesh", "meshes"), describe(sum));
  return workbench::build_scene(placed, objects, options);
}

template <class Hierarchy>
void save(const Hierarchy& hierarchy, const Options& options, const std::string& description,
          workbench::ProgressBar& bar) {
  if (options.output == standard_output) {
    bar.clear();
    return write_output(standard_output, saved_bytes(hierarchy));
  }
  hierarchy.save(options.output);
  bar.clear();
  write_output(standard_output, fmt::format("{}: {}\n", options.output, description));
}

// Those of every type that other commands measure with, in smaller pictures.
std::vector<kerf::Ray> sample_viewpoints(const workbench::Scene& scene, unsigned threads) {
  kerf::BuildOptions plain;
  plain.threads = threads;
  const kerf::Bvh bvh = kerf::build(scene.mesh(), plain);
  const workbench::RaySetOptions size = workbench::affordable(scene, bvh, {.width = 128, .height = 96});
  std::vector<kerf::Ray> rays;
  for (const workbench::RayType type : workbench::ray_types) {
    const workbench::RaySet set = workbench::make_rays(scene, bvh, type, size);
    rays.insert(rays.end(), set.rays.begin(), set.rays.end());
  }
  return rays;
}

void run(const Options& options) {
  workbench::ProgressBar bar;
  kerf::BuildOptions build;
  build.builder = parse_builder("--builder", options.builder).builder;
  build.quality = parse_quality("--quality", options.quality);
  if (!options.seconds.empty())
    build.max_refinement_seconds = parse_number("--seconds", options.seconds, 0.0, max_seconds);
  build.alpha = parse_alpha("--alpha", options.alpha);
  build.threads = parse_whole("--threads", options.threads, 0, max_threads);
  build.progress = [&](float fraction) {
    bar.show(fraction, "build");
    return true;
  };
  check_output(options.output);
  require_writable(options.output);
  std::vector<kerf::Ray> rays;
  if (!options.rays.empty() && options.rays != rays_of_viewpoints) rays = workbench::load_rays(options.rays);
  const workbench::Scene scene =
      std::move(load_scenes({options.scene}, options.format, workbench::Repeats::kept).front());
  if (scene.placed) {
    if (!options.rays.empty())
      workbench::raise(kerf::Error::invalid_argument, scene.name,
                       "--rays is for one mesh, and this is a scene of instances");
    std::string description;
    const kerf::Scene places =
        name_errors(scene, [&] { return build_places(*scene.placed, build, description); });
    return save(places, options, description, bar);
  }
  const kerf::Bvh bvh = name_errors(scene, [&] {
    if (options.rays == rays_of_viewpoints) rays = sample_viewpoints(scene, build.threads);
    build.sample_rays = rays;
    return kerf::build(scene.mesh(), build);
  });
  save(bvh, options, describe(bvh.statistics()), bar);
}

}  // namespace

void add_build_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("build", "Build the hierarchy of a scene and save it");
  command->add_option("SCENE", options->scene, scene_help)->type_name("")->required();
  command->add_option("-o,--output", options->output, "The .kerf file to write; - is standard output")
      ->check(names_a_file())
      ->type_name("FILE")
      ->required();
  command->add_option("--builder", options->builder, builder_names())
      ->type_name(builder_names("|", "|"))
      ->capture_default_str();
  command->add_option("--quality", options->quality, std::string(quality_names) + ": how good a tree")
      ->type_name("NAME")
      ->capture_default_str();
  command
      ->add_option("--seconds", options->seconds,
                   "Improve the tree for so long at most; it then depends on the speed of the machine")
      ->type_name("S");
  command
      ->add_option(
          "--rays", options->rays,
          "Make the tree for rays such as these: a text file with origin and direction on each line, "
          "or auto for rays from the scene's viewpoints")
      ->check(names_a_file())
      ->type_name("FILE|auto");
  command->add_option("--alpha", options->alpha, "Overlap above which a spatial split is tried, from 0 to 1")
      ->type_name("A")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads that build; 0 is all there are")
      ->type_name("N")
      ->capture_default_str();
  add_format_option(*command, options->format);
  command->callback([options] { run(*options); });
}

}  // namespace kerf_tool
