#include "workbench/open/scene_spec.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>

#include "workbench/base/raise.hpp"
#include "workbench/generate/generated_scenes.hpp"

namespace workbench {
namespace {

using kerf::Error;

/// Below this range scenes are empty, above it they exceed any memory.
constexpr double min_detail = 0.001, max_detail = 10000.0;

double parse_number(std::string_view spec, std::string_view key, std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    raise(Error::invalid_argument, spec, "{} must be a number, not '{}'", key, text);
  }
  return value;
}

void apply_option(std::string_view spec, std::string_view option, SceneSpec& result) {
  const std::size_t equals = option.find('=');
  const std::string_view key = option.substr(0, equals);
  if (key != "rotate" && key != "detail") {
    raise(Error::invalid_argument, spec,
          "unknown option '{}'; the options are rotate=DEGREES and detail=FACTOR", key);
  }
  if (equals == std::string_view::npos) {
    raise(Error::invalid_argument, spec, "{} needs a value, {}=...", key, key);
  }
  const double value = parse_number(spec, key, option.substr(equals + 1));
  if (key == "rotate") {
    result.rotate = value;
  } else if (value >= min_detail && value <= max_detail) {
    result.detail = value;
  } else {
    raise(Error::invalid_argument, spec, "detail must be from {} to {}, not {}", min_detail, max_detail,
          option.substr(equals + 1));
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
