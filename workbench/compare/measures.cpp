#include "workbench/compare/measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace workbench {
namespace {

std::string four_digits(double value) {
  const double size = std::abs(value);
  if (size > 0.0 && size < 0.1) return fmt::format("{:.3g}", value);
  return fmt::format("{:.{}f}", value, size >= 1000.0 ? 0 : size >= 100.0 ? 1 : size >= 10.0 ? 2 : 3);
}

// A dash where no ray was traced.
std::string speed(double mrays_per_s) {
  return mrays_per_s == 0.0 ? "-" : four_digits(mrays_per_s);
}

std::string count(double value) {
  return format_count(static_cast<std::size_t>(value));
}
std::string mebibytes(double bytes) {
  return four_digits(bytes / (1024.0 * 1024.0));
}

constexpr std::array<Measure<BuilderFigures>, 7> tree_list{{
    {"sah", "SAH", "Surface area heuristic: the expected cost of a random line through the whole scene",
     false, [](const BuilderFigures& f) { return f.sah; }, four_digits},
    {"epo", "EPO",
     "End-point overlap: the cost of nodes whose boxes hold the point where a ray ends, but not its triangle",
     false, [](const BuilderFigures& f) { return f.epo; }, four_digits},
    {"lcv", "LCV", "Leaf count variability: the standard deviation of the number of leaves that a line meets",
     false, [](const BuilderFigures& f) { return f.lcv; }, four_digits},
    {"references", "references", "Triangles in leaves, each counted once per leaf that holds it", false,
     [](const BuilderFigures& f) { return static_cast<double>(f.references); }, count},
    {"nodes", "nodes", "Inner nodes and leaves of the structure that is traced", false,
     [](const BuilderFigures& f) { return static_cast<double>(f.nodes); }, count},
    {"bytes", "MiB", "Memory of the structure that is traced, triangles included", false,
     [](const BuilderFigures& f) { return static_cast<double>(f.bytes); }, mebibytes},
    {"build_ms", "build ms",
     "From arrays of triangles to a structure ready to trace; for esc and evh with the search for the "
     "threshold",
     false, [](const BuilderFigures& f) { return f.build_ms; }, four_digits},
}};

constexpr std::array<Measure<RayFigures>, 3> ray_list{{
    {"steps", "steps/ray", "Inner nodes that a ray visits", false,
     [](const RayFigures& f) { return f.steps; }, four_digits},
    {"triangle_tests", "tests/ray", "Triangles that a ray is tested against", false,
     [](const RayFigures& f) { return f.triangle_tests; }, four_digits},
    {"mrays_per_s", "Mrays/s",
     "Millions of rays per second that one thread traces without counting: the best of several rounds", true,
     [](const RayFigures& f) { return f.mrays_per_s; }, speed},
}};

}  // namespace

std::span<const Measure<BuilderFigures>> tree_measures() {
  return tree_list;
}
std::span<const Measure<RayFigures>> ray_measures() {
  return ray_list;
}

std::string_view title(RayType type) {
  switch (type) {
    case RayType::primary:
      return "primary";
    case RayType::ao:
      return "ambient occlusion";
    case RayType::diffuse:
      return "diffuse";
  }
  return "";
}

std::string_view meaning(RayType type) {
  switch (type) {
    case RayType::primary:
      return "from the camera through every pixel, in tiles of 8×8: the closest hit";
    case RayType::ao:
      return "from the primary hits, cosine-distributed, a quarter of the scene's diagonal long: any hit";
    case RayType::diffuse:
      return "from the primary hits, cosine-distributed, of any length: the closest hit";
  }
  return "";
}

double rays_per_second(const BuilderFigures& builder, std::initializer_list<RayType> types) {
  double rays = 0.0, seconds = 0.0;
  for (const RayType type : types) {
    const RayFigures& figures = builder.rays[static_cast<std::size_t>(type)];
    if (figures.count == 0) continue;
    rays += static_cast<double>(figures.count);
    seconds += 1e-6 * static_cast<double>(figures.count) / figures.mrays_per_s;
  }
  return seconds > 0.0 ? rays / seconds : 0.0;
}

std::vector<bool> best_of(std::span<const double> values, bool higher_is_better) {
  std::vector<bool> best(values.size(), false);
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  if (values.empty() || *lowest == *highest) return best;
  const double target = higher_is_better ? *highest : *lowest;
  std::transform(values.begin(), values.end(), best.begin(),
                 [target](double value) { return value == target; });
  return best;
}

std::string format_ratio(double value, double base) {
  if (!(base > 0.0) || !(value > 0.0)) return "";
  return fmt::format("{:.2f}×", value / base);
}

std::string format_alpha(float alpha) {
  constexpr float plain = 0.01f;  // from here on, decimals are shorter
  if (alpha == 0.0f || alpha >= plain) return fmt::format("{}", alpha);
  const double exponent = std::floor(std::log10(alpha) + 1e-6);
  return fmt::format("{:.4g}e{:.0f}", alpha / std::pow(10.0, exponent), exponent);
}

std::string name_with_budget(const BuilderFigures& builder) {
  return fmt::format("{} {}", builder.name, builder.budget);
}

}  // namespace workbench
