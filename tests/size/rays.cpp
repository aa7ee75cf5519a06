// A program that builds a hierarchy and traces rays: one by one, many at once, and with a filter.
#include <array>
#include <cstdint>
#include <cstdio>
#include <vector>

#include <kerf/kerf.hpp>

int main() {
  const std::vector<std::array<float, 3>> positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::array<unsigned, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const kerf::Bvh bvh = kerf::build({.vertices = positions, .triangles = triangles});

  const std::vector<kerf::Ray> rays(1000, {.origin = {0.75f, 0.25f, 2}, .direction = {0, 0, -1}});
  std::vector<kerf::Hit> hits(rays.size());
  std::vector<std::uint8_t> flags(rays.size());
  bvh.intersect(rays, hits);
  bvh.occluded(rays, flags);
  const auto filtered = bvh.intersect(rays[0], [](const kerf::Hit& hit) { return hit.primitive == 0; });
  std::printf("%d %d %d %d %d\n", bvh.intersect(rays[0]).has_value(), bvh.occluded(rays[0]),
              static_cast<bool>(hits[999]), flags[999], filtered.has_value());
}
