#include "arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "workbench/open/load_scene.hpp"
#include "workbench/open/scene_spec.hpp"

namespace kerf_tool {
namespace {

using kerf::BuilderInfo;

constexpr unsigned max_picture_side = 16384;

[[noreturn]] void refuse(const std::string& option, const std::string& sentence) {
  throw CLI::ValidationError(option, sentence);
}

// Reads a number that all of `text` spells. Returns false if there is none.
template <class Number>
bool read(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
  }
  return parts;
}

// Coordinates far from the origin are further apart as floats than corners of small triangles are.
void warn_of_flattened_triangles(const workbench::Scene& scene) {
  if (scene.contents.flattened_triangles == 0) return;
  fmt::print(
      stderr,
      "kerf: {}: rounding to floats takes the area of {} of {} triangles; subtract a point near them from "
      "all coordinates before they are written (a local frame)\n",
      scene.name, scene.contents.flattened_triangles,
      scene.placed ? scene.placed->stored_triangles() : scene.triangles.size());
}

}  // namespace

std::string builder_names(std::string_view separator, std::string_view last) {
  const auto builders = kerf::builders();
  std::string names;
  for (const BuilderInfo& info : builders) {
    if (!names.empty()) names += &info == &builders.back() ? last : separator;
    names += info.name;
  }
  return names;
}

BuilderInfo parse_builder(const std::string& option, const std::string& text) {
  for (const BuilderInfo& info : kerf::builders()) {
    if (text == info.name) return info;
  }
  refuse(option,
         fmt::format("there is no builder '{}'; the builders are {}", text, builder_names(", ", " and ")));
}

std::vector<NamedBuild> parse_builders(const std::string& option, const std::string& text) {
  std::vector<NamedBuild> builds;
  for (const std::string& word : split(text, ',')) {
    const std::size_t colon = word.find(':');
    const BuilderInfo info = parse_builder(option, word.substr(0, colon));
    NamedBuild build{.name = word, .options = {.builder = info.builder}};
    if (colon != std::string::npos) build.options.quality = parse_quality(option, word.substr(colon + 1));
    if (build.options.quality == kerf::Quality::fast) build.name = info.name;
    const auto is_same = [&](const NamedBuild& other) { return other.name == build.name; };
    if (std::any_of(builds.begin(), builds.end(), is_same))
      refuse(option, fmt::format("{} is named twice", build.name));
    builds.push_back(std::move(build));
  }
  return builds;
}

kerf::Quality parse_quality(const std::string& option, const std::string& text) {
  if (text == "fast") return kerf::Quality::fast;
  if (text == "high") return kerf::Quality::high;
  if (text == "best") return kerf::Quality::best;
  refuse(option, fmt::format("must be {}, not '{}'", quality_names, text));
}

float parse_alpha(const std::string& option, const std::string& text) {
  float alpha = 0.0f;
  if (!read(text, alpha) || !(alpha >= 0.0f && alpha <= 1.0f)) {
    refuse(option, fmt::format("must be a number from 0 to 1, not '{}'", text));
  }
  return alpha;
}

std::vector<float> parse_alphas(const std::string& option, const std::string& text) {
  std::vector<float> alphas;
  for (const std::string& word : split(text, ',')) alphas.push_back(parse_alpha(option, word));
  return alphas;
}

std::vector<float> parse_budgets(const std::string& option, const std::string& text) {
  std::vector<float> budgets;
  for (const std::string& word : split(text, ',')) {
    float budget = 0.0f;
    if (!read(word, budget) || !(budget >= 1.0f && budget <= 16.0f))
      refuse(option, fmt::format("must be numbers from 1 to 16, not '{}'", word));
    if (std::find(budgets.begin(), budgets.end(), budget) != budgets.end())
      refuse(option, fmt::format("{} is named twice", word));
    budgets.push_back(budget);
  }
  return budgets;
}

unsigned parse_whole(const std::string& option, const std::string& text, unsigned min, unsigned max) {
  unsigned value = 0;
  if (!read(text, value) || value < min || value > max) {
    refuse(option, fmt::format("must be a whole number from {} to {}, not '{}'", min, max, text));
  }
  return value;
}

kerf::Vec3f parse_point(const std::string& option, const std::string& text) {
  const std::vector<std::string> words = split(text, ',');
  kerf::Vec3f point;
  bool good = words.size() == 3;
  for (int axis = 0; good && axis < 3; ++axis)
    good = read(words[static_cast<std::size_t>(axis)], point[axis]) && std::isfinite(point[axis]);
  if (!good) refuse(option, fmt::format("must be three numbers, X,Y,Z, not '{}'", text));
  return point;
}

double parse_number(const std::string& option, const std::string& text, double min, double max) {
  double value = 0.0;
  if (!read(text, value) || !(value > min && value < max)) {
    refuse(option, fmt::format("must be a number between {} and {}, not '{}'", min, max, text));
  }
  return value;
}

PictureSize parse_size(const std::string& option, const std::string& text) {
  const std::vector<std::string> sides = split(text, 'x');
  unsigned width = 0, height = 0;
  if (sides.size() != 2 || !read(sides[0], width) || !read(sides[1], height) || width < 1 || height < 1 ||
      width > max_picture_side || height > max_picture_side) {
    refuse(option, fmt::format("must be WIDTHxHEIGHT, each from 1 to {}, not '{}'", max_picture_side, text));
  }
  return {width, height};
}

CLI::Validator names_a_file() {
  return {[](const std::string& name) {
            return name.empty() ? std::string("needs a name, not an empty one") : std::string();
          },
          ""};
}

void add_format_option(CLI::App& command, std::string& format) {
  command
      .add_option("--format", format,
                  "What the files of scenes are, whatever their names: for pipes, /dev/stdin (or -), and "
                  "names without an ending")
      ->check(CLI::IsMember({"obj", "ply", "stl", "gltf", "glb", "kerf"}))
      ->type_name("FORMAT");
}

std::vector<workbench::Scene> load_scenes(const std::vector<std::string>& specs, const std::string& format,
                                          workbench::Repeats repeats) {
  for (const std::string& spec : specs) {
    try {
      workbench::parse_scene_spec(spec);
    } catch (const kerf::Error& error) {
      refuse("SCENE", error.what());
    }
  }
  std::vector<workbench::Scene> scenes;
  for (const std::string& spec : specs) {
    scenes.push_back(workbench::load_scene(spec, format, repeats));
    warn_of_flattened_triangles(scenes.back());
  }
  return scenes;
}

}  // namespace kerf_tool
