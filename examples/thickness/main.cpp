// How thick a part is where a beam goes through it: all hits of a ray, in pairs of in and out.
#include <cstdio>
#include <vector>

#include <kerf/kerf.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"

int main() {
  const shapes::Mesh ring = shapes::make_ring();
  const kerf::Bvh bvh = kerf::build({.vertices = ring.vertices, .triangles = ring.triangles});

  Picture picture(240, 240);
  float thickest = 0.0f;
  std::size_t odd = 0;
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      const float px = 0.0125f * (static_cast<float>(x) - 119.5f),
                  py = 0.0125f * (119.5f - static_cast<float>(y));
      const kerf::Ray beam{.origin = {px - 0.9f, py, 3.0f}, .direction = {0.3f, 0.0f, -1.0f}};
      float inside = 0.0f, sign = -1.0f;
      std::size_t hits = 0;
      bvh.all_hits(beam, [&](const kerf::Hit& hit) {  // in order: in, out, in, out
        inside += sign * hit.t;
        sign = -sign;
        ++hits;
      });
      odd += hits % 2;
      thickest = std::max(thickest, inside);
      const float light = 1.0f - 0.75f * inside;  // as an X-ray shows it
      picture.set(x, y, light * light, light * light, light);
    }
  }
  if (!picture.save("thickness.ppm")) return 1;
  std::printf("thickness.ppm: %.2f at most; beams with an odd number of walls: %zu\n", thickest, odd);
}
