// Pictures in memory and as PNG.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace workbench {

/// Red, green and blue as a PNG stores them: sRGB, 0 to 255.
using Pixel = std::array<std::uint8_t, 3>;

struct Image {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<Pixel> pixels;  ///< row after row from the top left

  Image(std::size_t w, std::size_t h) : width(w), height(h), pixels(w * h) {}
  Pixel& at(std::size_t x, std::size_t y) { return pixels[y * width + x]; }
  const Pixel& at(std::size_t x, std::size_t y) const { return pixels[y * width + x]; }
};

/// Paints the rectangle of which (x, y) is the upper left pixel, as far as it lies in the image.
void fill(Image& image, std::size_t x, std::size_t y, std::size_t width, std::size_t height, Pixel pixel);

/// The bytes of a PNG file. Throws `kerf::Error::out_of_memory`.
std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace workbench
