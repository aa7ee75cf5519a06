// A program that is compiled as C++11 and as C++17.
#include <cstdio>

#include <kerf/kerf11.hpp>

int main() {
  const std::vector<float> vertices = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<std::uint32_t> triangles = {0, 1, 2, 0, 2, 3};
  const kerf11::Bvh square(kerf11::mesh(vertices, triangles));
  const kerf_ray down = {{0.75f, 0.25f, 2}, {0, 0, -1}, 0, 10};
  kerf_hit hit;
  if (square.intersect(down, hit))
    std::printf("triangle %u at t = %g, C++ of %ld\n", hit.primitive, hit.t, static_cast<long>(__cplusplus));
}
