// A mountain valley: a height field of even triangles. Spatial splits gain nothing here, and must not hurt.
#include <algorithm>
#include <cmath>

#include "workbench/generate/generate.hpp"
#include "workbench/generate/mesh_maker.hpp"
#include "workbench/generate/noise.hpp"

namespace workbench {
namespace {

constexpr float size = 1000.0f;
constexpr double squares = 320.0;  // along each side at detail 1

float height(float x, float z) {
  const float nx = x / size, nz = z / size;
  const float mountains = fractal_noise(5.0f * nx + 3.3f, 5.0f * nz + 1.7f, 8, 11);
  const float ridges = 1.0f - std::abs(fractal_noise(3.0f * nx, 3.0f * nz, 7, 47));
  const float bend = 0.5f + 0.18f * value_noise(2.5f * nz, 0.5f, 5);
  const float from_valley = std::min(1.0f, std::abs(nx - bend) / 0.3f);
  const float rise = from_valley * from_valley * (3.0f - 2.0f * from_valley);
  return 40.0f * mountains * (0.25f + rise) + 180.0f * rise * ridges;
}

}  // namespace

Scene generate_terrain(double detail) {
  const std::uint32_t side = scaled(squares, std::sqrt(detail), 2);
  MeshMaker maker;
  maker.add_grid(side, side, [](float u, float v) {
    const float x = u * size, z = (1.0f - v) * size;
    return kerf::Vec3f{x, height(x, z), z};
  });
  const auto above = [](float x, float z, float distance) {
    return kerf::Vec3f{x, height(x, z) + distance, z};
  };
  Scene scene;
  scene.vertices = std::move(maker.vertices());
  scene.triangles = std::move(maker.triangles());
  scene.viewpoints = {{.position = above(500, 960, 60), .target = above(500, 400, 40)},
                      {.position = above(120, 150, 90), .target = above(560, 620, 0)},
                      {.position = {1350, 650, 1350}, .target = {480, 40, 480}, .vertical_field_of_view = 45},
                      {.position = above(560, 300, 25), .target = above(300, 520, 60)}};
  return scene;
}

}  // namespace workbench
