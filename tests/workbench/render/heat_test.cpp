#include "workbench/render/heat.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace workbench {
namespace {

// Relative luminance of sRGB (IEC 61966-2-1).
double luminance(const Pixel& pixel) {
  const auto linear = [](std::uint8_t value) {
    const double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(pixel[0]) + 0.7152 * linear(pixel[1]) + 0.0722 * linear(pixel[2]);
}

TEST(Heat, HotterIsLighter) {
  double before = -1.0;
  for (int i = 0; i <= 200; ++i) {
    const double now = luminance(heat_colour(static_cast<float>(i) / 200.0f));
    EXPECT_GE(now, before) << i;
    before = now;
  }
  EXPECT_EQ(heat_colour(1.0f), heat_colour(5.0f));
}

TEST(Heat, TheScaleOfSeveralMapsServesAllOfThem) {
  const HeatMap cool{.width = 1000, .height = 1, .costs = std::vector<float>(1000, 10.0f)};
  HeatMap hot = cool;
  for (float& cost : hot.costs) cost = 55.0f;
  hot.costs[0] = 1e6f;  // one ray must not darken all others
  const HeatMap maps[] = {cool, hot};
  EXPECT_EQ(common_scale(maps), 60.0f);
  EXPECT_EQ(common_scale({}), 1.0f);
}

}  // namespace
}  // namespace workbench
