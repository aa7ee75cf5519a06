// From what a user writes to values. All throw `CLI::ValidationError` with a sentence that names the option.
#pragma once

#include <cstddef>
#include <new>
#include <string>
#include <vector>

#include <kerf/build.hpp>
#include <kerf/error.hpp>

#include "workbench/scene/scene.hpp"

namespace kerf_tool {

/// What a SCENE is, for the help of every command.
inline constexpr const char* scene_help =
    "A file (.obj .ply .stl .gltf .glb, gzipped or not, or .kerf) or a generated scene, then optionally "
    ":rotate=DEGREES,detail=N";

/// More threads than any machine has that this runs on; beyond it stands a mistake.
inline constexpr unsigned most_threads = 1024;

/// `bvh,sbvh`: one or more builders, none twice.
std::vector<kerf::Builder> parse_builders(const std::string& option, const std::string& text);

/// One builder.
kerf::Builder parse_builder(const std::string& option, const std::string& text);

/// A number from 0 to 1.
float parse_alpha(const std::string& option, const std::string& text);

/// `1,0.1,0`: one or more of them.
std::vector<float> parse_alphas(const std::string& option, const std::string& text);

/// A whole number from `least` to `most`.
unsigned parse_whole(const std::string& option, const std::string& text, unsigned least, unsigned most);

struct PictureSize {
  std::size_t width;
  std::size_t height;
};

/// `1280x800`: each from 1 to 16384.
PictureSize parse_size(const std::string& option, const std::string& text);

/// Loads the scenes, all of them before any other work is done: what is wrong with one shows at once.
std::vector<workbench::Scene> load_scenes(const std::vector<std::string>& specs);

/// What `work` returns. Errors of the library know no file: this puts the scene's name before their sentence.
template <class Work>
auto name_errors(const workbench::Scene& scene, const Work& work) {
  try {
    return work();
  } catch (const kerf::Error& error) {
    throw kerf::Error(error.code(), scene.name + ": " + error.what());
  } catch (const std::bad_alloc&) {
    throw kerf::Error(kerf::Error::out_of_memory, scene.name + ": not enough memory");
  }
}

}  // namespace kerf_tool
