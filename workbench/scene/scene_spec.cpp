#include "workbench/scene/scene_spec.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <kerf/error.hpp>

#include "workbench/generate/generated_scenes.hpp"

namespace workbench {
namespace {

using kerf::Error;

/// Far beyond both ends scenes are empty or larger than any memory.
constexpr double least_detail = 0.001, most_detail = 10000.0;

double number(std::string_view spec, std::string_view key, std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw Error(Error::invalid_argument, fmt::format("{}: {} must be a number, not '{}'", spec, key, text));
  }
  return value;
}

void apply_option(std::string_view spec, std::string_view option, SceneSpec& result) {
  const std::size_t equals = option.find('=');
  const std::string_view key = option.substr(0, equals);
  if (key != "rotate" && key != "detail") {
    throw Error(
        Error::invalid_argument,
        fmt::format("{}: unknown option '{}'; there are rotate=DEGREES and detail=FACTOR", spec, key));
  }
  if (equals == std::string_view::npos) {
    throw Error(Error::invalid_argument, fmt::format("{}: {} needs a value, {}=...", spec, key, key));
  }
  const double value = number(spec, key, option.substr(equals + 1));
  if (key == "rotate") {
    result.rotate = value;
  } else if (value >= least_detail && value <= most_detail) {
    result.detail = value;
  } else {
    throw Error(Error::invalid_argument, fmt::format("{}: detail must be from {} to {}, not {}", spec,
                                                     least_detail, most_detail, option.substr(equals + 1)));
  }
}

bool exists(std::string_view file) {
  std::error_code error;
  return std::filesystem::exists(std::filesystem::path(file), error);
}

}  // namespace

SceneSpec parse_scene_spec(std::string_view spec) {
  const std::size_t colon = spec.rfind(':');
  if (colon == std::string_view::npos || exists(spec))
    return {.source = std::string(spec), .rotate = 0, .detail = {}};
  const std::string_view source = spec.substr(0, colon);
  std::string_view options = spec.substr(colon + 1);
  const bool can_be_options = options.find('=') != std::string_view::npos ||
                              find_generated_scene(source) != nullptr || exists(source);
  if (!can_be_options) return {.source = std::string(spec), .rotate = 0, .detail = {}};

  SceneSpec result{.source = std::string(source), .rotate = 0, .detail = {}};
  for (;;) {
    const std::size_t comma = options.find(',');
    apply_option(spec, options.substr(0, comma), result);
    if (comma == std::string_view::npos) return result;
    options.remove_prefix(comma + 1);
  }
}

}  // namespace workbench
