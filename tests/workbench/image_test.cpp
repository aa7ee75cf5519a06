#include "workbench/render/image.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <stb/stb_image.h>

#include "workbench/render/heat.hpp"

// The decoder is not the library that encoded: stb_image knows nothing of libpng.
TEST(Image, APngReadByAnotherDecoderIsTheSamePicture) {
  workbench::Image image(37, 11);
  for (std::size_t y = 0; y < image.height; ++y) {
    for (std::size_t x = 0; x < image.width; ++x) {
      image.at(x, y) = {static_cast<std::uint8_t>(7 * x), static_cast<std::uint8_t>(23 * y),
                        static_cast<std::uint8_t>(x ^ y)};
    }
  }
  const std::vector<std::uint8_t> png = workbench::encode_png(image);
  int width = 0, height = 0, channels = 0;
  stbi_uc* decoded =
      stbi_load_from_memory(png.data(), static_cast<int>(png.size()), &width, &height, &channels, 0);
  ASSERT_NE(decoded, nullptr);
  EXPECT_EQ(width, 37);
  EXPECT_EQ(height, 11);
  ASSERT_EQ(channels, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    EXPECT_EQ((workbench::Pixel{decoded[3 * i], decoded[3 * i + 1], decoded[3 * i + 2]}), image.pixels[i])
        << i;
  }
  stbi_image_free(decoded);
}

// Relative luminance of sRGB (IEC 61966-2-1).
static double luminance(const workbench::Pixel& pixel) {
  const auto linear = [](std::uint8_t value) {
    const double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(pixel[0]) + 0.7152 * linear(pixel[1]) + 0.0722 * linear(pixel[2]);
}

TEST(HeatView, HotterIsLighter) {
  double before = -1.0;
  for (int i = 0; i <= 200; ++i) {
    const double now = luminance(workbench::heat_colour(static_cast<float>(i) / 200.0f));
    EXPECT_GE(now, before) << i;
    before = now;
  }
  EXPECT_EQ(workbench::heat_colour(1.0f), workbench::heat_colour(5.0f));
}

TEST(HeatView, TheScaleOfSeveralMapsServesAllOfThem) {
  const workbench::HeatMap cool{.width = 1000, .height = 1, .costs = std::vector<float>(1000, 10.0f)};
  workbench::HeatMap hot = cool;
  for (float& cost : hot.costs) cost = 55.0f;
  hot.costs[0] = 1e6f;  // one ray must not darken all others
  const workbench::HeatMap maps[] = {cool, hot};
  EXPECT_EQ(workbench::common_scale(maps), 60.0f);
  EXPECT_EQ(workbench::common_scale({}), 1.0f);
}
