// The voxels inside a closed mesh: one exact question for the middle of each, all in one call.
#include <cstdint>
#include <cstdio>
#include <vector>

#include <kerf/kerf.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"

int main() {
  const shapes::Mesh ring = shapes::make_ring();
  const kerf::Bvh bvh = kerf::build({.vertices = ring.vertices, .triangles = ring.triangles});

  constexpr std::size_t nx = 96, ny = 96, nz = 28;
  constexpr float size = 3.0f / nx;
  std::vector<kerf::Vec3f> middles;
  for (std::size_t k = 0; k < nz; ++k) {
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        const auto place = [](std::size_t cell, std::size_t count) {
          return size * (static_cast<float>(cell) + 0.5f - 0.5f * static_cast<float>(count));
        };
        middles.push_back({place(i, nx), place(j, ny), place(k, nz)});
      }
    }
  }
  std::vector<std::uint8_t> inside(middles.size());
  bvh.contains(middles, inside);

  // Seen from above: the highest voxel of each column, higher ones brighter.
  Picture picture(3 * nx, 3 * ny);
  std::size_t filled = 0;
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      std::size_t height = 0;
      for (std::size_t k = 0; k < nz; ++k) {
        if (inside[(k * ny + j) * nx + i] == 0) continue;
        height = k + 1;
        ++filled;
      }
      const float light = static_cast<float>(height) / nz;
      for (std::size_t y = 0; y < 3; ++y) {
        for (std::size_t x = 0; x < 3; ++x)
          picture.set(3 * i + x, 3 * (ny - 1 - j) + y, 0.9f * light * light, 0.6f * light,
                      0.05f + 0.3f * light);
      }
    }
  }
  if (!picture.save("voxels.ppm")) return 1;
  std::printf("voxels.ppm: %zu of %zu voxels are inside\n", filled, middles.size());
}
