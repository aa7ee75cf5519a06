#include "workbench/generate/noise.hpp"

#include <cmath>
#include <cstdint>

#include "workbench/sampling/random.hpp"

namespace workbench {
namespace {

float height_at(std::int32_t x, std::int32_t y, unsigned seed) {
  const std::uint64_t place =
      std::uint64_t{static_cast<std::uint32_t>(x)} << 32 | static_cast<std::uint32_t>(y);
  RandomNumbers random(place ^ scramble(seed));
  return random.between(-1.0f, 1.0f);
}

// The quintic with two derivatives zero at both ends (Perlin 2002, "Improving Noise").
float ease(float t) {
  return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

float mix(float a, float b, float t) {
  return a + (b - a) * t;
}

}  // namespace

float value_noise(float x, float y, unsigned seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int32_t>(fx), iy = static_cast<std::int32_t>(fy);
  const float u = ease(x - fx), v = ease(y - fy);
  return mix(mix(height_at(ix, iy, seed), height_at(ix + 1, iy, seed), u),
             mix(height_at(ix, iy + 1, seed), height_at(ix + 1, iy + 1, seed), u), v);
}

float fractal_noise(float x, float y, int octaves, unsigned seed) {
  float sum = 0.0f, scale = 1.0f;
  for (int i = 0; i < octaves; ++i) {
    sum += scale * value_noise(x / scale, y / scale, seed + static_cast<unsigned>(i));
    scale *= 0.5f;
  }
  return sum;
}

}  // namespace workbench
