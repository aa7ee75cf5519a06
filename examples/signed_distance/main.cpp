// A slice through the field of signed distances around a mesh: negative inside, its sign exact.
#include <cmath>
#include <cstdio>
#include <vector>

#include <kerf/kerf.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"

int main() {
  const shapes::Mesh ring = shapes::make_ring();
  const kerf::Bvh bvh = kerf::build({.vertices = ring.vertices, .triangles = ring.triangles});

  Picture picture(320, 160);
  std::vector<kerf::Vec3f> points;
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x)
      points.push_back(
          {0.0125f * (static_cast<float>(x) - 159.5f), 0.0f, 0.0125f * (79.5f - static_cast<float>(y))});
  }
  std::vector<float> distances(points.size());
  bvh.signed_distance(points, distances);

  float deepest = 0.0f;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float d = distances[i];
    deepest = std::min(deepest, d);
    const float line = std::abs(std::remainder(d, 0.1f)) < 0.008f ? 0.45f : 1.0f;  // every tenth of a unit
    const float far = line / (1.0f + 2.0f * std::abs(d));
    d < 0.0f ? picture.set(i % picture.width, i / picture.width, far, 0.45f * far, 0.12f * far)
             : picture.set(i % picture.width, i / picture.width, 0.2f * far, 0.45f * far, far);
  }
  if (!picture.save("signed_distance.ppm")) return 1;
  std::printf("signed_distance.ppm: the deepest point lies %.2f below the surface\n", -deepest);
}
