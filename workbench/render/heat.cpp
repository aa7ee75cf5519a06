#include "workbench/render/heat.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <kerf/inspect.hpp>

#include "workbench/base/parallel.hpp"
#include "workbench/rays/camera.hpp"

namespace workbench {
namespace {

// From night blue through magenta and orange to pale yellow. Lightness rises evenly, so that the picture
// reads the same in grey and for the colour-blind.
constexpr std::array<Pixel, 8> heat_stops{{{6, 8, 30},
                                           {38, 18, 92},
                                           {92, 22, 122},
                                           {150, 38, 114},
                                           {206, 62, 82},
                                           {242, 108, 44},
                                           {252, 176, 58},
                                           {252, 250, 190}}};

// Where scales may end, times a power of ten. Quarters of these are round numbers as well, for the legend.
constexpr float round_ends[] = {1.0f, 1.2f, 1.6f, 2.0f, 2.4f, 2.8f, 3.2f, 4.0f, 5.0f, 6.0f, 8.0f};

// The fraction of the pixels that may lie beyond the end of the scale. Without it, a few extreme rays would
// darken all others.
constexpr double clipped_fraction = 0.002;

// Letters of three by five dots, row after row, for numbers in pictures, and which they are.
constexpr std::string_view letters = "0123456789.kM";
constexpr std::array<std::string_view, letters.size()> dots_of{
    "####.##.##.####", ".#.##..#..#.###", "###..#####..###", "###..####..####", "#.##.####..#..#",
    "####..###..####", "####..####.####", "###..#..#..#..#", "####.#####.####", "####.####..####",
    ".............#.", "#..#.###.#.##.#", "#.#####.##.##.#"};
constexpr std::size_t dot_size = 2;  // pixels

void draw_number(Image& image, std::size_t x, std::size_t y, std::string_view number) {
  for (const char c : number) {
    const std::string_view dots = dots_of[letters.find(c)];
    for (std::size_t i = 0; i < dots.size(); ++i) {
      if (dots[i] == '#')
        fill(image, x + i % 3 * dot_size, y + i / 3 * dot_size, dot_size, dot_size, {255, 255, 255});
    }
    x += 4 * dot_size;
  }
}

// In `letters` alone, and short enough to stand beside the next.
std::string label(float value) {
  if (value >= 1e6f) return fmt::format("{:.4g}M", 1e-6f * value);
  if (value >= 1e4f) return fmt::format("{:.4g}k", 1e-3f * value);
  return value < 1e-4f ? "0" : fmt::format("{:.4g}", value);
}

}  // namespace

HeatMap trace_heat(const kerf::Bvh& bvh, const Viewpoint& viewpoint, std::size_t width, std::size_t height,
                   std::size_t block) {
  HeatMap map{.width = width, .height = height, .costs = std::vector<float>(width * height)};
  const Camera camera(viewpoint, width, height);
  const float middle = 0.5f * static_cast<float>(block);
  parallel_for((height + block - 1) / block, [&](std::size_t row) {
    const std::size_t top = row * block, bottom = std::min(top + block, height);
    for (std::size_t x = 0; x < width; x += block) {
      kerf::TraversalCounters counters;
      intersect(bvh, camera.ray_through(static_cast<float>(x) + middle, static_cast<float>(top) + middle),
                counters);
      const auto cost = static_cast<float>(counters.steps + counters.triangle_tests);
      for (std::size_t y = top; y < bottom; ++y)
        std::fill_n(map.costs.begin() + static_cast<std::ptrdiff_t>(y * width + x),
                    std::min(block, width - x), cost);
    }
  });
  return map;
}

float common_scale(std::span<const HeatMap> maps) {
  std::vector<float> costs;
  for (const HeatMap& map : maps) costs.insert(costs.end(), map.costs.begin(), map.costs.end());
  if (costs.empty()) return 1.0f;
  const auto rank =
      static_cast<std::size_t>(static_cast<double>(costs.size() - 1) * (1.0 - clipped_fraction));
  std::nth_element(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(rank), costs.end());
  const float limit = std::max(costs[rank], 1.0f);
  const float decade = std::pow(10.0f, std::floor(std::log10(limit)));
  for (const float end : round_ends) {
    if (end * decade >= limit) return end * decade;
  }
  return 10.0f * decade;
}

Pixel heat_colour(float fraction) {
  const float place = std::clamp(fraction, 0.0f, 1.0f) * static_cast<float>(heat_stops.size() - 1);
  const std::size_t stop = std::min(static_cast<std::size_t>(place), heat_stops.size() - 2);
  const float weight = place - static_cast<float>(stop);
  Pixel mixed{};
  for (std::size_t c = 0; c < mixed.size(); ++c) {
    const float from = heat_stops[stop][c], to = heat_stops[stop + 1][c];
    mixed[c] = static_cast<std::uint8_t>(std::lround(from + weight * (to - from)));
  }
  return mixed;
}

Image colour(const HeatMap& map, float scale) {
  Image image(map.width, map.height);
  std::transform(map.costs.begin(), map.costs.end(), image.pixels.begin(),
                 [scale](float cost) { return heat_colour(cost / scale); });
  return image;
}

void draw_legend(Image& image, float scale) {
  constexpr std::size_t margin = 8, bar_width = 200, bar_height = 10, gap = 4, number_height = 5 * dot_size;
  constexpr std::size_t width = bar_width + 40 + 2 * margin;  // the last number stands out
  constexpr std::size_t height = bar_height + gap + number_height + 2 * margin;
  if (image.width < width || image.height < 2 * height) return;
  const std::size_t top = image.height - height;
  fill(image, 0, top, width, height, {0, 0, 0});
  for (std::size_t x = 0; x < bar_width; ++x) {
    const float fraction = static_cast<float>(x) / static_cast<float>(bar_width - 1);
    fill(image, margin + x, top + margin, 1, bar_height, heat_colour(fraction));
  }
  for (std::size_t quarter = 0; quarter <= 4; ++quarter) {
    const std::size_t x = margin + quarter * (bar_width - 1) / 4;
    fill(image, x, top + margin + bar_height, 1, gap - 1, {255, 255, 255});
    draw_number(image, x, top + margin + bar_height + gap,
                label(0.25f * static_cast<float>(quarter) * scale));
  }
}

}  // namespace workbench
