// Things are set onto hilly ground: the closest point of a surface, and the triangles near a place.
#include <cmath>
#include <cstdio>
#include <vector>

#include <kerf/kerf.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"

namespace {

constexpr unsigned cells = 120;

float height(float x, float y) {
  return 0.25f * std::sin(3.0f * x) * std::cos(2.5f * y) + 0.05f * std::sin(11.0f * x + 7.0f * y);
}

shapes::Mesh make_hills() {
  shapes::Mesh mesh;
  for (unsigned j = 0; j <= cells; ++j) {
    for (unsigned i = 0; i <= cells; ++i) {
      const float x = 4.0f * static_cast<float>(i) / cells - 2.0f,
                  y = 4.0f * static_cast<float>(j) / cells - 2.0f;
      mesh.vertices.push_back({x, y, height(x, y)});
      const unsigned a = j * (cells + 1) + i;
      if (i == cells || j == cells) continue;
      mesh.triangles.push_back({a, a + 1, a + cells + 2});
      mesh.triangles.push_back({a, a + cells + 2, a + cells + 1});
    }
  }
  return mesh;
}

}  // namespace

int main() {
  const shapes::Mesh hills = make_hills();
  const kerf::Bvh bvh = kerf::build({.vertices = hills.vertices, .triangles = hills.triangles});

  // Straight down: a ray. However it lies nearest: the closest point.
  const kerf::Vec3f balloon{0.4f, -0.3f, 1.5f};
  const auto below = bvh.intersect({.origin = balloon, .direction = {0, 0, -1}});
  const auto nearest = bvh.closest_point(balloon);
  if (!below || !nearest) return 1;
  std::printf("%.3f above ground, %.3f from the nearest hill\n", below->t, nearest->distance);
  std::printf("%zu triangles within 0.2 of where it lands\n",
              bvh.within({balloon.x, balloon.y, balloon.z - below->t}, 0.2f).size());

  Picture picture(240, 240);
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      const kerf::Vec3f place{static_cast<float>(x) / 60.0f - 1.99f, 1.99f - static_cast<float>(y) / 60.0f,
                              0.6f};
      const auto at = bvh.closest_point(place);
      if (!at) return 1;
      const float line = std::abs(std::remainder(at->distance, 0.1f)) < 0.008f ? 0.4f : 1.0f;
      const float near = line * (1.0f - at->distance);
      picture.set(x, y, 0.7f * near * near, 0.8f * near, 0.35f * near);
    }
  }
  return picture.save("drop_to_ground.ppm") ? 0 : 1;
}
