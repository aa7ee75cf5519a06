#include "workbench/render/image.hpp"

#include <algorithm>
#include <cstring>

#include <kerf/error.hpp>
#include <png.h>

namespace workbench {

void fill(Image& image, std::size_t x, std::size_t y, std::size_t width, std::size_t height, Pixel pixel) {
  for (std::size_t v = y; v < std::min(y + height, image.height); ++v) {
    for (std::size_t u = x; u < std::min(x + width, image.width); ++u) image.at(u, v) = pixel;
  }
}

std::vector<std::uint8_t> encode_png(const Image& image) {
  png_image header;
  std::memset(&header, 0, sizeof(header));
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;

  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<std::uint8_t> bytes(size);
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr)) {
    throw kerf::Error(kerf::Error::out_of_memory, header.message);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace workbench
