// Two triangles, one ray: the smallest program that hits something.
#include <array>
#include <cstdio>
#include <vector>

#include <kerf/kerf.hpp>

int main() {
  // A square in the plane z = 0. kerf looks at the caller's memory and copies what it needs.
  const std::vector<std::array<float, 3>> positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::array<unsigned, 3>> triangles{{0, 1, 2}, {0, 2, 3}};

  const kerf::Bvh bvh = kerf::build({.vertices = positions, .triangles = triangles});

  const kerf::Ray ray{.origin = {0.75f, 0.25f, 2}, .direction = {0, 0, -1}};
  if (const auto hit = bvh.intersect(ray)) {
    std::printf("hit triangle %u of mesh %u at t = %g, u = %g, v = %g\n", hit->primitive, hit->mesh, hit->t,
                hit->u, hit->v);
  } else {
    std::printf("missed\n");
  }
}
