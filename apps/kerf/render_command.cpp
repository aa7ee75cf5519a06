#include <memory>

#include <fmt/format.h>
#include <kerf/kerf.hpp>

#include "arguments.hpp"
#include "commands.hpp"
#include "output.hpp"
#include "workbench/render/heat.hpp"
#include "workbench/render/image.hpp"
#include "workbench/render/render.hpp"
#include "workbench/terminal/progress.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

struct Options {
  std::string scene;
  std::string output;
  std::string mode = "shaded";
  std::string builder;  // empty: that of a .kerf file, else sbvh
  std::string view = "0";
  std::string size = "1280x800";
};

enum class Mode { shaded, ao, steps };

Mode parse_mode(const std::string& text) {
  if (text == "shaded") return Mode::shaded;
  if (text == "ao") return Mode::ao;
  if (text == "steps") return Mode::steps;
  throw CLI::ValidationError("--mode",
                             fmt::format("there is no mode '{}'; the modes are shaded, ao and steps", text));
}

Image render(const Scene& scene, const kerf::Bvh& bvh, Mode mode, const Viewpoint& viewpoint,
             PictureSize size) {
  ProgressBar bar;
  const RenderOptions options{.width = size.width,
                              .height = size.height,
                              .samples = 3,
                              .ambient_samples = mode == Mode::ao ? 24u : 8u,
                              .progress = [&](double fraction) { bar.show(fraction, "render"); }};
  if (mode == Mode::shaded) return render_shaded(scene, bvh, viewpoint, options);
  if (mode == Mode::ao) return render_ambient_occlusion(scene, bvh, viewpoint, options);
  const HeatMap map = trace_heat(bvh, viewpoint, size.width, size.height);
  return colour(map, common_scale({&map, 1}));
}

void run(const Options& options) {
  const Mode mode = parse_mode(options.mode);
  const kerf::Builder builder =
      parse_builder("--builder", options.builder.empty() ? "sbvh" : options.builder).builder;
  const unsigned view = parse_whole("--view", options.view, 0, 999);
  const PictureSize size = parse_size("--size", options.size);
  if (options.output != standard_output) require_writable(options.output);
  const Scene scene = std::move(load_scenes({options.scene}).front());
  if (view >= scene.viewpoints.size()) {
    throw CLI::ValidationError("--view", fmt::format("{} has the viewpoints 0 to {}, not {}", scene.name,
                                                     scene.viewpoints.size() - 1, view));
  }
  const Image image = name_errors(scene, [&] {
    const bool saved = scene.hierarchy && options.builder.empty();
    const kerf::Bvh bvh = saved ? *scene.hierarchy : kerf::build(scene.mesh(), {.builder = builder});
    return render(scene, bvh, mode, scene.viewpoints[view], size);
  });
  const std::vector<std::uint8_t> png = encode_png(image);
  write_output(options.output, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace

void add_render_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("render", "Make a picture of a scene");
  command->add_option("SCENE", options->scene, scene_help)->type_name("")->required();
  command->add_option("-o,--output", options->output, "The PNG file to write, - is standard output")
      ->type_name("FILE")
      ->required();
  command->add_option("--mode", options->mode, "shaded, ao (ambient occlusion) or steps (the heat view)")
      ->type_name("NAME")
      ->capture_default_str();
  command
      ->add_option("--builder", options->builder,
                   builder_names() + "; if none is given, the hierarchy of a .kerf file, else sbvh")
      ->type_name("NAME");
  command->add_option("--view", options->view, "Number of the viewpoint, from 0")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--size", options->size, "WIDTHxHEIGHT in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace kerf_tool
