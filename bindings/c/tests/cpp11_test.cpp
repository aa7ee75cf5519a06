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
  for (std::size_t i = 2; i < vertices.size(); i += 3) vertices[i] += 0.5f;
  const kerf_refit_report report = moved.refit(kerf11::mesh(vertices, triangles));
  expect(report.cost_ratio == 1.0 && report.rebuilt == 0, "a stack that was moved as a whole");
  expect(moved.intersect(up, hit) && hit.t == 1.5f, "triangles have moved");
  expect(bvh.intersect(up, hit) && hit.t == 1.0f, "a handle that shared them stays as it was");

  kerf_transform aside = {{{1, 0, 0, 10}, {0, 1, 0, 0}, {0, 0, 2, 0}}};
  const kerf11::Scene pair({kerf11::instance(bvh), kerf11::instance(bvh, &aside)});
  const kerf_ray up_there = {{10.25f, 0.25f, -1}, {0, 0, 1}, 0, 1000};
  kerf_scene_hit there;
  expect(pair.intersect(up_there, there) && there.t == 1.0f && there.instance == 1, "an instance is hit");
  expect(pair.all_hits(up_there).size() == 40 && pair.count_hits(up_there) == 40, "all hits of a scene");
  expect(pair.all_hits(up_there)[39].t == 79.0f, "under a scale");
  const float near[3] = {10.25f, 0.25f, 6.5f};
  expect(pair.closest_point(near).distance == 0.5f && pair.within(near, 2.0f).size() == 2,
         "points of a scene");
  expect(pair.nearest(near, 3).size() == 3 && pair.side(near) == KERF_OUTSIDE, "the nearest of a scene");
  const kerf_box around_one = {{10.1f, 0.1f, -0.5f}, {10.9f, 0.9f, 1.0f}};
  expect(pair.triangles_in(around_one).size() ==
             bvh.triangles_in({{0.1f, 0.1f, -0.25f}, {0.9f, 0.9f, 0.5f}}).size(),
         "triangles of a scene in a box");
  expect(pair.touching_pairs().empty() && pair.touching_pairs(pair).size() == 80, "touching instances");
  const kerf_transform far_off = {{{1, 0, 0, 0}, {0, 1, 0, 100}, {0, 0, 1, 0}}};
  const kerf11::Scene two({kerf11::instance(pair), kerf11::instance(pair, &far_off)});
  expect(two.instance_count() == 4 && two.path(3) == std::vector<std::uint32_t>({1, 1}), "scenes in a scene");
  expect(two.intersect(std::vector<kerf_ray>(10, up_there))[9].instance == 1, "many rays through scenes");
  expect(two.occluded(rays, 1)[0] == 1 && two.bounds().upper[1] >= 101.0f, "both scenes are there");
  two.save("kerf_cpp11_scene.kerf");
  expect(kerf11::Scene::load("kerf_cpp11_scene.kerf").instance_count() == 4 &&
             kerf11::Scene::map("kerf_cpp11_scene.kerf").intersect(up_there, there) && there.instance == 1,
         "a scene from a file");
  std::remove("kerf_cpp11_scene.kerf");
  kerf11::Scene taken = two, empty;
  empty = std::move(taken);
  expect(empty.occluded(up) && !taken.occluded(up), "a scene that was moved from is one of nothing");

  try {
    kerf11::Bvh::load("no such file.kerf");
    expect(false, "a missing file throws");
  } catch (const kerf11::Error& error) {
    expect(error.status() == KERF_IO && std::string(error.what()).find("no such file") != std::string::npos,
           "an error with its sentence");
  }
  return 0;
}
