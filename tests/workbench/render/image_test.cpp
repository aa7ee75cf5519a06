#include "workbench/render/image.hpp"

#include <gtest/gtest.h>
#include <stb/stb_image.h>

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
