#include "workbench/open/load_scene.hpp"

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "workbench/base/nearest_word.hpp"
#include "workbench/base/raise.hpp"
#include "workbench/formats/load_file.hpp"
#include "workbench/generate/generated_scenes.hpp"
#include "workbench/open/scene_spec.hpp"
#include "workbench/sampling/angles.hpp"
#include "workbench/scene/viewpoints.hpp"

namespace workbench {
namespace {

using kerf::Vec3f;

// Turns points about z, then y, then x, by the same angle each time.
class Rotation {
 public:
  explicit Rotation(double degrees) : angle_(sine_cosine(degrees / 360.0)) {}

  Vec3f operator()(const Vec3f& p) const {
    const auto [s, c] = angle_;
    const Vec3f about_z{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    const Vec3f about_y{c * about_z.x + s * about_z.z, about_z.y, c * about_z.z - s * about_z.x};
    return {about_y.x, c * about_y.y - s * about_y.z, s * about_y.y + c * about_y.z};
  }

 private:
  SineCosine angle_;
};

void rotate(Scene& scene, double degrees) {
  const Rotation rotation(degrees);
  for (Vec3f& vertex : scene.vertices) vertex = rotation(vertex);
  if (scene.placed) {
    for (PlacedMeshes::Place& place : scene.placed->places) {
      const kerf::Transform before = place.transform;
      for (int j = 0; j < 3; ++j) {
        Vec3f axis;
        axis[j] = 1.0f;
        const Vec3f turned = rotation(axis);  // a column of the map
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 4; ++k) {
            double& number = place.transform.rows[i][k];
            number = (j == 0 ? 0.0 : number) + double{turned[i]} * before.rows[j][k];
          }
        }
      }
    }
  }
  for (Viewpoint& viewpoint : scene.viewpoints) {
    viewpoint.position = rotation(viewpoint.position);
    viewpoint.target = rotation(viewpoint.target);
    viewpoint.up = rotation(viewpoint.up);
  }
}

// What a user wrote who may have misspelt a generated scene: a word that is no path and no file.
[[noreturn]] void raise_no_such(const std::string& source) {
  if (source.find_first_of("./") != std::string::npos) raise(kerf::Error::io, source, "no such file");
  std::vector<std::string> names;
  for (const GeneratedScene& scene : generated_scenes()) names.emplace_back(scene.name);
  raise(kerf::Error::io, source, "no such file, and no generated scene of that name{}{}",
        did_you_mean(source, names), " (kerf scenes lists them)");
}

Scene load_source(const SceneSpec& spec, std::string_view format, Repeats repeats) {
  if (const GeneratedScene* generated = format.empty() ? find_generated_scene(spec.source) : nullptr) {
    return generated->generate(spec.detail.value_or(1.0));
  }
  if (spec.detail) {
    raise(kerf::Error::invalid_argument, spec.source, "detail is for generated scenes, not for files");
  }
  const std::string file = spec.source == "-" ? "/dev/stdin" : spec.source;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) raise_no_such(file);
  Scene scene = load_file(file, format, repeats);
  scene.viewpoints = choose_viewpoints(scene);
  scene.has_authored_viewpoints = false;
  return scene;
}

}  // namespace

Scene load_scene(std::string_view text, std::string_view format, Repeats repeats) {
  const SceneSpec spec = parse_scene_spec(text);
  Scene scene = load_source(spec, format, repeats);
  if (spec.rotate != 0.0) {
    rotate(scene, spec.rotate);
    scene.hierarchy.reset();  // it belongs to the vertices that were saved
  }
  scene.name = std::string(text);
  return scene;
}

}  // namespace workbench
