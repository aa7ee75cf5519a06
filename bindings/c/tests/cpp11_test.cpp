// A program in C++11: what the handle does beyond the functions in C.
#include <cstdio>
#include <cstdlib>

#include <kerf/kerf11.hpp>

static void expect(bool holds, const char* claim) {
  if (holds) return;
  std::printf("failed: %s\n", claim);
  std::exit(1);
}

int main() {
  static_assert(__cplusplus == 201103L, "compiled as C++11");
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t i = 0; i < 40; ++i) {  // a stack of triangles
    const float z = static_cast<float>(i);
    vertices.insert(vertices.end(), {0, 0, z, 1, 0, z, 0, 1, z});
    triangles.insert(triangles.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  }
  const kerf11::Bvh bvh(kerf11::mesh(vertices, triangles));
  const kerf_ray up = {{0.25f, 0.25f, -1}, {0, 0, 1}, 0, 1000};
  kerf_hit hit;
  expect(bvh.intersect(up, hit) && hit.t == 1.0f && hit.primitive == 0, "the closest hit");
  expect(bvh.all_hits(up).size() == 40 && bvh.count_hits(up) == 40, "a list longer than the first try");
  expect(bvh.all_hits(up)[39].t == 40.0f, "a list in order");
  const float point[3] = {0.25f, 0.25f, 5.25f};
  expect(bvh.closest_point(point).distance == 0.25f, "the closest point");
  expect(bvh.nearest(point, 3).size() == 3, "the nearest");
  expect(bvh.within(point, 1.0f).size() == 2, "within a radius");
  expect(bvh.touching_pairs(bvh).size() == 40, "touching pairs");

  kerf11::Bvh copy = bvh, moved = std::move(copy);
  expect(moved.occluded(up) && !copy.occluded(up), "a handle that was moved from holds nothing");
  copy = moved;
  expect(copy.occluded(up), "a handle that was assigned");

  const std::vector<kerf_ray> rays(100, up);
  expect(bvh.intersect(rays, 2).back().t == 1.0f && bvh.occluded(rays)[99] == 1, "many rays");
  try {
    kerf11::Bvh::load("no such file.kerf");
    expect(false, "a missing file throws");
  } catch (const kerf11::Error& error) {
    expect(error.status() == KERF_IO && std::string(error.what()).find("no such file") != std::string::npos,
           "an error with its sentence");
  }
  return 0;
}
