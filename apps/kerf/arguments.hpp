// From what a user writes to values. All functions throw `CLI::ValidationError` with a sentence that names
// the option.
#pragma once

#include <cstddef>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <kerf/error.hpp>
#include <kerf/inspect.hpp>

#include "workbench/scene/scene.hpp"

namespace kerf_tool {

/// Describes a SCENE in the help of every command.
inline constexpr const char* scene_help =
    "A file (.obj .ply .stl .gltf .glb, gzipped or not, or .kerf) or a generated scene, then optionally "
    ":rotate=DEGREES,detail=N";

/// No machine has more threads: a larger number is a mistake.
inline constexpr unsigned max_threads = 1024;

/// The names of all builders, with `last` before the last one: `bvh, sbvh, esc or evh`.
std::string builder_names(std::string_view separator = ", ", std::string_view last = " or ");

/// A builder and a quality, and the name that tables give the two: `sbvh`, or `sbvh:best`.
struct NamedBuild {
  std::string name;
  kerf::BuildOptions options;
};

/// `bvh,sbvh,sbvh:best`: one or more builders, each with the quality behind the colon, none twice.
std::vector<NamedBuild> parse_builders(const std::string& option, const std::string& text);

/// One builder, by its name.
kerf::BuilderInfo parse_builder(const std::string& option, const std::string& text);

/// `fast`, `high` or `best`.
inline constexpr const char* quality_names = "fast, high or best";
kerf::Quality parse_quality(const std::string& option, const std::string& text);

/// A number from 0 to 1.
float parse_alpha(const std::string& option, const std::string& text);

/// `1,0.1,0`: one or more such numbers.
std::vector<float> parse_alphas(const std::string& option, const std::string& text);

/// `1.1,1.5,2`: one or more numbers from 1 to 16, none twice.
std::vector<float> parse_budgets(const std::string& option, const std::string& text);

/// A whole number from `min` to `max`.
unsigned parse_whole(const std::string& option, const std::string& text, unsigned min, unsigned max);

struct PictureSize {
  std::size_t width;
  std::size_t height;
};

/// `1,-2.5,3e4`: three finite numbers.
kerf::Vec3f parse_point(const std::string& option, const std::string& text);

/// A number greater than `min` and less than `max`.
double parse_number(const std::string& option, const std::string& text, double min, double max);

/// `1280x800`: each from 1 to 16384.
PictureSize parse_size(const std::string& option, const std::string& text);

/// For options that name a file: an empty name is refused instead of being taken for none.
CLI::Validator names_a_file();

/// Adds `--format`, which says what scene files are whatever their names.
void add_format_option(CLI::App& command, std::string& format);

/// Loads all scenes; files are of `format` if that is not empty. Commands do so before any other work, so
/// that errors in any of them show at once. A line on standard error names scenes of which rounding to floats
/// destroys triangles.
std::vector<workbench::Scene> load_scenes(const std::vector<std::string>& specs, const std::string& format,
                                          workbench::Repeats repeats = workbench::Repeats::flattened);

/// Returns what `work` returns. Errors of the library name no file, so this puts the name of the scene before
/// their sentence.
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
