// Pictures as files that every viewer of images opens (PPM), without a library.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

struct Picture {
  std::size_t width, height;
  std::vector<std::uint8_t> bytes;  // red, green, blue, row after row from the top left

  Picture(std::size_t w, std::size_t h) : width(w), height(h), bytes(3 * w * h) {}

  /// Each of the three from 0 to 1, in linear light.
  void set(std::size_t x, std::size_t y, float red, float green, float blue) {
    std::uint8_t* const pixel = &bytes[3 * (y * width + x)];
    const float light[] = {red, green, blue};
    for (int i = 0; i < 3; ++i)
      pixel[i] = static_cast<std::uint8_t>(
          std::lround(255.0f * std::pow(std::clamp(light[i], 0.0f, 1.0f), 1.0f / 2.2f)));
  }

  bool save(const std::string& name) const {
    std::FILE* const file = std::fopen(name.c_str(), "wb");
    if (file == nullptr) return false;
    std::fprintf(file, "P6 %zu %zu 255\n", width, height);
    const bool whole = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    return std::fclose(file) == 0 && whole;
  }
};
