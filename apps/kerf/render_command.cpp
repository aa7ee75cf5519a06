#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <kerf/kerf.hpp>

#include "arguments.hpp"
#include "commands.hpp"
#include "output.hpp"
#include "workbench/render/heat.hpp"
#include "workbench/render/image.hpp"
#include "workbench/render/render.hpp"
#include "workbench/scene/placed.hpp"
#include "workbench/scene/traced.hpp"
#include "workbench/scene/viewpoints.hpp"
#include "workbench/terminal/progress.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

struct Options {
  std::string scene;
  std::string output;
  std::string mode = "shaded";
  std::string builder;  // empty: that of a .kerf file, else sbvh
  std::string view;     // empty: from outside for files, the first for generated scenes
  std::string eye, at, up, fov;
  std::string size = "1280x800";
  std::string scale;
  std::string format;
};

enum class Mode { shaded, ao, steps };

Mode parse_mode(const std::string& text) {
  if (text == "shaded") return Mode::shaded;
  if (text == "ao") return Mode::ao;
  if (text == "steps") return Mode::steps;
  throw CLI::ValidationError("--mode",
                             fmt::format("there is no mode '{}'; the modes are shaded, ao and steps", text));
}

// `y`, `z` or a vector.
kerf::Vec3f parse_up(const std::string& text) {
  if (text.empty() || text == "y") return {0, 1, 0};
  if (text == "z") return {0, 0, 1};
  const kerf::Vec3f up = parse_point("--up", text);
  if (up == kerf::Vec3f{}) throw CLI::ValidationError("--up", "must be y, z or a direction, not 0,0,0");
  return up;
}

// What a user asks of the camera, checked as far as it can be without the scene.
struct CameraOptions {
  std::optional<kerf::Vec3f> eye, at;
  kerf::Vec3f up;
  std::optional<float> fov;
  std::optional<unsigned> number;  // of a viewpoint
  std::string name;                // of a view
};

CameraOptions parse_camera(const Options& options) {
  CameraOptions camera{.eye = {}, .at = {}, .up = parse_up(options.up), .fov = {}, .number = {}, .name = {}};
  if (options.eye.empty() && !options.at.empty())
    throw CLI::ValidationError("--at", "needs --eye, the place to look from");
  if (!options.eye.empty() && !options.view.empty())
    throw CLI::ValidationError("--eye", "is a place to look from, and so is --view: give one of them");
  if (!options.eye.empty()) camera.eye = parse_point("--eye", options.eye);
  if (!options.at.empty()) camera.at = parse_point("--at", options.at);
  if (camera.eye && camera.eye == camera.at) throw CLI::ValidationError("--at", "is where --eye is");
  if (!options.fov.empty()) camera.fov = static_cast<float>(parse_number("--fov", options.fov, 0.0, 180.0));
  const bool is_number = options.view.find_first_not_of("0123456789") == std::string::npos;
  if (options.view.empty()) return camera;
  if (is_number) {
    camera.number = parse_whole("--view", options.view, 0, 999);
  } else if (std::find(std::begin(view_names), std::end(view_names), options.view) != std::end(view_names)) {
    camera.name = options.view;
  } else {
    throw CLI::ValidationError(
        "--view", fmt::format("there is no view '{}'; there are {} and the scene's viewpoints, from 0",
                              options.view, fmt::join(view_names, ", ")));
  }
  return camera;
}

// Without a word of the user: generated scenes have a first viewpoint that shows them; of a file it is known
// neither whether there is room inside nor what is up.
Viewpoint choose_viewpoint(const Scene& scene, const CameraOptions& camera, bool upward_given,
                           PictureSize size) {
  const auto finish = [&](Viewpoint viewpoint) {
    if (camera.fov) viewpoint.vertical_field_of_view = *camera.fov;
    return viewpoint;
  };
  const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  if (camera.eye) {
    const kerf::Vec3f middle = named_view(scene, "front", camera.up, aspect)->target;
    return finish({.position = *camera.eye, .target = camera.at.value_or(middle), .up = camera.up});
  }
  if (!camera.name.empty()) return finish(*named_view(scene, camera.name, camera.up, aspect));
  if (!camera.number && (upward_given || !scene.has_authored_viewpoints))
    return finish(*named_view(scene, "iso", camera.up, aspect));
  const unsigned number = camera.number.value_or(0);
  if (number >= scene.viewpoints.size()) {
    throw CLI::ValidationError("--view", fmt::format("{} has the viewpoints 0 to {}, not {}", scene.name,
                                                     scene.viewpoints.size() - 1, number));
  }
  return finish(scene.viewpoints[number]);
}

// `bvh` is what is traced, or stands for it if that is a scene.
Image render(const Traced& traced, const kerf::Bvh& bvh, Mode mode, const Viewpoint& viewpoint,
             PictureSize size, const std::string& scale) {
  ProgressBar bar;
  const RenderOptions asked{.width = size.width,
                            .height = size.height,
                            .samples = mode == Mode::steps ? 1u : 3u,
                            .ambient_samples = mode == Mode::ao ? 24u : 8u,
                            .progress = [&](double fraction) { bar.show(fraction, "render"); }};
  const RenderOptions options = affordable(bvh, viewpoint, asked);
  if (const std::string remark = remark_on(options, asked); !remark.empty()) {
    bar.clear();
    fmt::print(stderr, "kerf: {}\n", remark);
  }
  if (mode == Mode::shaded) return render_shaded(traced, viewpoint, options);
  if (mode == Mode::ao) return render_ambient_occlusion(traced, viewpoint, options);
  const HeatMap map = trace_heat(bvh, viewpoint, size.width, size.height, options.block);
  const float end =
      scale.empty() ? common_scale({&map, 1}) : static_cast<float>(parse_number("--scale", scale, 0.0, 1e9));
  Image image = colour(map, end);
  draw_legend(image, end);
  return image;
}

// A picture in a file whose name says another format would be refused by what opens it.
void check_output(const std::string& name) {
  const std::string ending = std::filesystem::path(name).extension().string();
  if (name == standard_output || ending.empty() || ending == ".png" || ending == ".PNG") return;
  if (std::filesystem::exists(name) && !std::filesystem::is_regular_file(name)) return;
  throw CLI::ValidationError("--output",
                             fmt::format("the picture is a PNG, whose name ends in .png, not {}", ending));
}

void run(const Options& options) {
  const Mode mode = parse_mode(options.mode);
  const kerf::Builder builder =
      parse_builder("--builder", options.builder.empty() ? "sbvh" : options.builder).builder;
  const CameraOptions camera = parse_camera(options);
  const PictureSize size = parse_size("--size", options.size);
  if (!options.scale.empty()) {
    parse_number("--scale", options.scale, 0.0, 1e9);
    if (mode != Mode::steps) throw CLI::ValidationError("--scale", "is that of --mode steps");
  }
  check_output(options.output);
  require_writable(options.output);
  // Steps are counted in one hierarchy, which is also what a builder is asked for.
  const Repeats repeats =
      mode == Mode::steps || !options.builder.empty() ? Repeats::flattened : Repeats::kept;
  const Scene scene = std::move(load_scenes({options.scene}, options.format, repeats).front());
  const Viewpoint viewpoint = choose_viewpoint(scene, camera, !options.up.empty(), size);
  const Image image = name_errors(scene, [&] {
    if (scene.placed) {
      const kerf::Scene places = build_scene(*scene.placed, build_objects(*scene.placed));
      return render(Traced(scene, places), build_stand_in(*scene.placed), mode, viewpoint, size,
                    options.scale);
    }
    const bool saved = scene.hierarchy && options.builder.empty();
    const kerf::Bvh bvh = saved ? *scene.hierarchy : kerf::build(scene.mesh(), {.builder = builder});
    return render(Traced(scene, bvh), bvh, mode, viewpoint, size, options.scale);
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
      ->check(names_a_file())
      ->type_name("FILE")
      ->required();
  command->add_option("--mode", options->mode, "shaded, ao (ambient occlusion) or steps (the heat view)")
      ->type_name("shaded|ao|steps")
      ->capture_default_str();
  command
      ->add_option("--builder", options->builder,
                   builder_names() + "; if none is given, the hierarchy of a .kerf file, else sbvh")
      ->type_name(builder_names("|", "|"));
  command
      ->add_option(
          "--view", options->view,
          fmt::format("{} or the number of a viewpoint, from 0; if not given, iso for files and 0 for "
                      "generated scenes",
                      fmt::join(view_names, ", ")))
      ->type_name("VIEW");
  command->add_option("--eye", options->eye, "Where the camera is, in place of a view")->type_name("X,Y,Z");
  command->add_option("--at", options->at, "What --eye looks at; if not given, the middle of the scene")
      ->type_name("X,Y,Z");
  command->add_option("--up", options->up, "What is up: y, z or a direction; if not given, y")
      ->type_name("y|z|X,Y,Z");
  command->add_option("--fov", options->fov, "Vertical field of view; if not given, that of the view, or 60")
      ->type_name("DEGREES");
  command
      ->add_option("--scale", options->scale,
                   "Steps and triangle tests at the end of the colours of --mode steps, so that pictures "
                   "compare; if not given, what few pixels exceed")
      ->type_name("N");
  command->add_option("--size", options->size, "WIDTHxHEIGHT in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  add_format_option(*command, options->format);
  command->callback([options] { run(*options); });
}

}  // namespace kerf_tool
