// A picture of a ring on a floor, with the sun's shadow: closest hits, normals, and rays that only ask
// whether anything is in the way.
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <kerf/kerf.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"
#include "../common/vectors.hpp"

int main() {
  const shapes::Mesh ring = shapes::make_ring(), ground = shapes::make_floor(8.0f, -0.4f);
  const std::array<kerf::TriangleMesh, 2> meshes{
      kerf::TriangleMesh{.vertices = ring.vertices, .triangles = ring.triangles},
      kerf::TriangleMesh{.vertices = ground.vertices, .triangles = ground.triangles}};
  const kerf::Bvh bvh = kerf::build(meshes);

  const Vec3f eye{2.2f, -2.6f, 1.9f}, forward = unit({-2.2f, 2.6f, -2.2f}),
                                      right = unit(cross(forward, {0, 0, 1}));
  const Vec3f up = cross(right, forward), sun = unit({0.9f, 0.3f, 1.1f});
  Picture picture(320, 240);
  std::size_t lit = 0, shadowed = 0;
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      const float across = (static_cast<float>(x) + 0.5f - 160.0f) / 240.0f;
      const float above = (120.0f - static_cast<float>(y) - 0.5f) / 240.0f;
      const kerf::Ray ray{.origin = eye, .direction = forward + across * right + above * up};
      const auto hit = bvh.intersect(ray);
      if (!hit) {
        picture.set(x, y, 0.35f, 0.5f, 0.7f);
        continue;
      }
      const kerf::HitGeometry at = bvh.geometry(ray, *hit);
      const Vec3f normal = unit(at.front ? at.normal : -1.0f * at.normal);
      // A little above the surface, so that the ray does not hit what it starts from.
      const Vec3f from = ray.origin + hit->t * ray.direction + 1e-4f * normal;
      const bool dark = bvh.occluded({.origin = from, .direction = sun});
      ++(dark ? shadowed : lit);
      const float light = 0.18f + (dark ? 0.0f : 0.75f * std::max(0.0f, dot(normal, sun)));
      hit->mesh == 0 ? picture.set(x, y, light, 0.55f * light, 0.25f * light)
                     : picture.set(x, y, 0.6f * light, 0.6f * light, 0.55f * light);
    }
  }
  if (!picture.save("first_picture.ppm")) return 1;
  std::printf("first_picture.ppm: %zu pixels in the sun, %zu in the shade\n", lit, shadowed);
}
