// A curtain of chains in the wind: one ring, sixteen times in a chain, the chain nine times in the curtain.
// For each frame the curtain alone is built again, whatever the ring and the chain consist of.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"
#include "../common/vectors.hpp"

namespace {

// Every other ring is turned by a quarter about the vertical.
kerf::Scene hang_rings(const kerf::Bvh& ring, unsigned count) {
  std::vector<kerf::Instance> rings;
  for (unsigned i = 0; i < count; ++i) {
    const double down = -0.6 * i;
    rings.push_back({.object = ring,
                     .transform = i % 2 == 0
                                      ? kerf::Transform{{{0.3, 0, 0, 0}, {0, 0, 0.3, 0}, {0, 0.42, 0, down}}}
                                      : kerf::Transform{{{0, 0, 0.3, 0}, {0.3, 0, 0, 0}, {0, 0.42, 0, down}}},
                     .number = i % 2});
  }
  return kerf::build(rings);
}

// Chains side by side; a chain that is blown aside is sheared, so that its rings stay linked.
kerf::Scene hang_chains(const kerf::Scene& chain, unsigned count, double time) {
  std::vector<kerf::Instance> chains;
  for (unsigned i = 0; i < count; ++i) {
    const double x = 1.2 * (i - 0.5 * (count - 1)), aside = 0.15 * std::sin(time + 0.9 * i);
    chains.push_back({.scene = chain, .transform = {{{1, 0, -aside, x}, {0, 1, -0.2, 0}, {0, 0, 1, 0}}}});
  }
  return kerf::build(chains);
}

}  // namespace

int main() {
  const shapes::Mesh mesh = shapes::make_ring();
  const kerf::Bvh ring = kerf::build({.vertices = mesh.vertices, .triangles = mesh.triangles});
  const kerf::Scene chain = hang_rings(ring, 16);

  const Vec3f eye{1.5f, -11.0f, -3.2f}, sun = unit({-0.5f, -0.9f, 0.6f});
  Picture picture(320, 240);
  for (int frame = 0; frame < 3; ++frame) {
    const kerf::Scene curtain = hang_chains(chain, 9, 0.5 * frame);
    std::size_t lit = 0, shadowed = 0;
    for (std::size_t y = 0; y < picture.height; ++y) {
      for (std::size_t x = 0; x < picture.width; ++x) {
        const kerf::Ray ray{.origin = eye,
                            .direction = {(static_cast<float>(x) - 179.5f) / 280.0f, 1.0f,
                                          (119.5f - static_cast<float>(y)) / 280.0f}};
        const auto hit = curtain.intersect(ray);
        if (!hit) {
          picture.set(x, y, 0.35f, 0.5f, 0.7f);
          continue;
        }
        // From the outside to the inside: the chain, then the ring.
        const auto path = curtain.path(hit->instance);
        const kerf::Instance& in_chain = curtain.instances()[path[0]].scene.instances()[path[1]];
        const kerf::HitGeometry at = curtain.geometry(ray, *hit);
        const Vec3f normal = at.front ? at.normal : -1.0f * at.normal;
        const Vec3f from = ray.origin + hit->t * ray.direction + 1e-3f * normal;
        const bool dark = curtain.occluded({.origin = from, .direction = sun});
        ++(dark ? shadowed : lit);
        const float light = 0.18f + (dark ? 0.0f : 0.75f * std::max(0.0f, dot(normal, sun)));
        in_chain.number == 0 ? picture.set(x, y, light, 0.6f * light, 0.2f * light)
                             : picture.set(x, y, 0.7f * light, 0.7f * light, 0.75f * light);
      }
    }
    std::printf("frame %d, %u rings: %zu pixels in the sun, %zu in the shade\n", frame,
                curtain.instance_count(), lit, shadowed);
    if (!picture.save("chains" + std::to_string(frame) + ".ppm")) return 1;
  }
}
