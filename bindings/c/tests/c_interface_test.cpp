// The C interface against the library in C++: the same answers, and errors that say what is wrong.
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.h>
#include <kerf/kerf.hpp>
#include <kerf/kerf11.hpp>
#include <kerf/scene.hpp>

namespace {

// Programs that were compiled with an older header go on to work: these sizes never change.
static_assert(sizeof(kerf_ray) == 32 && sizeof(kerf_hit) == 20 && sizeof(kerf_surface_point) == 32);
static_assert(sizeof(kerf_primitive_id) == 8 && sizeof(kerf_touching_pair) == 16);
static_assert(sizeof(kerf_triangle) == 36 && sizeof(kerf_box) == 24 && sizeof(kerf_transform) == 96);
static_assert(sizeof(kerf_scene_hit) == 24 && sizeof(kerf_scene_point) == 36);
static_assert(sizeof(kerf_hit_geometry) == 52 && sizeof(kerf_mesh_statistics) == 48);
// These only grow, at their end.
static_assert(sizeof(kerf_mesh) == 64 && sizeof(kerf_double_mesh) == 64 && sizeof(kerf_build_options) == 88);
static_assert(sizeof(kerf_statistics) == 80 && sizeof(kerf_batch_options) == 16);
static_assert(sizeof(kerf_rays) == 160 && sizeof(kerf_hits) == 96 && sizeof(kerf_points) == 32);
static_assert(sizeof(kerf_refit_report) == 24 && sizeof(kerf_instance) == 128);
static_assert(sizeof(kerf_thread_pool) == 32);

struct Scene {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
  kerf_bvh* c = nullptr;
  kerf::Bvh cpp;

  ~Scene() { kerf_bvh_release(c); }
  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  kerf_mesh mesh() const { return kerf11::mesh(vertices, triangles); }
  void build() {
    const kerf_mesh view = mesh();
    ASSERT_EQ(kerf_build(&view, 1, nullptr, &c), KERF_OK) << kerf_last_error();
    cpp = kerf::build({.vertices = vertices, .triangles = triangles});
  }
};

// A closed surface: a grid around the unit sphere.
void make_sphere(Scene& scene, std::uint32_t rows = 24, std::uint32_t columns = 32) {
  const double pi = 3.14159265358979;
  for (std::uint32_t i = 1; i < rows; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) {
      const double a = pi * i / rows, b = 2 * pi * j / columns;
      for (const double x : {std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)})
        scene.vertices.push_back(static_cast<float>(x));
    }
  }
  const std::uint32_t top = (rows - 1) * columns, bottom = top + 1;
  scene.vertices.insert(scene.vertices.end(), {0, 0, 1, 0, 0, -1});
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    scene.triangles.insert(scene.triangles.end(), {a, b, c});
  };
  for (std::uint32_t j = 0; j < columns; ++j) {
    const std::uint32_t k = (j + 1) % columns, last = (rows - 2) * columns;
    add(top, j, k);
    add(bottom, last + k, last + j);
    for (std::uint32_t i = 0; i + 2 < rows; ++i) {
      const std::uint32_t row = i * columns, next = row + columns;
      add(row + j, next + j, next + k);
      add(row + j, next + k, row + k);
    }
  }
  scene.build();
}

template <class Cpp, class C>
Cpp as(const C& value) {
  return std::bit_cast<Cpp>(value);
}
template <class Cpp, class C>
std::vector<Cpp> as(const std::vector<C>& values) {
  std::vector<Cpp> result;
  for (const C& value : values) result.push_back(std::bit_cast<Cpp>(value));
  return result;
}

class CInterface : public ::testing::Test {
 protected:
  void SetUp() override { make_sphere(scene); }

  std::array<float, 3> point() {
    std::uniform_real_distribution<float> in(-1.5f, 1.5f);
    return {in(random), in(random), in(random)};
  }
  kerf_ray ray() {
    const auto o = point(), d = point();
    return {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, 0.0f, std::numeric_limits<float>::infinity()};
  }

  std::mt19937 random{1};
  Scene scene;
};

TEST_F(CInterface, OneRayIsAnsweredAsInCpp) {
  for (int i = 0; i < 300; ++i) {
    const kerf_ray from = ray();
    const auto to = as<kerf::Ray>(from);
    const auto hit = scene.cpp.intersect(to);
    kerf_hit found;
    ASSERT_EQ(kerf_intersect(scene.c, &from, &found), hit.has_value());
    ASSERT_EQ(as<kerf::Hit>(found), hit.value_or(kerf::Hit{}));
    ASSERT_EQ(kerf_occluded(scene.c, &from), hit.has_value());

    std::vector<kerf_hit> all(8);
    std::size_t count = 0;
    ASSERT_EQ(kerf_all_hits(scene.c, &from, all.data(), all.size(), &count), KERF_OK);
    all.resize(count);
    std::vector<kerf::Hit> expected;
    scene.cpp.all_hits(to, [&](const kerf::Hit& crossing) { expected.push_back(crossing); });
    ASSERT_EQ(as<kerf::Hit>(all), expected);
    ASSERT_EQ(kerf_count_hits(scene.c, &from, &count), KERF_OK);
    ASSERT_EQ(count, expected.size());
    std::vector<kerf_hit> visited;
    ASSERT_EQ(kerf_visit_hits(
                  scene.c, &from,
                  [](void* list, const kerf_hit* crossing) {
                    static_cast<std::vector<kerf_hit>*>(list)->push_back(*crossing);
                    return 1;
                  },
                  &visited),
              KERF_OK);
    ASSERT_EQ(as<kerf::Hit>(visited), expected);
    if (!hit) continue;
    kerf_hit_geometry geometry;
    ASSERT_EQ(kerf_get_geometry(scene.c, &from, &found, &geometry), KERF_OK);
    const kerf::HitGeometry expected_geometry = scene.cpp.geometry(to, *hit);
    ASSERT_EQ(geometry.normal[0], expected_geometry.normal.x);
    ASSERT_EQ(geometry.front != 0, expected_geometry.front);
  }
}

TEST_F(CInterface, AFilterIsAskedAndAMaskIsHeeded) {
  const auto even = [](void*, const kerf_hit* hit) { return static_cast<int>(hit->primitive % 2 == 0); };
  for (int i = 0; i < 100; ++i) {
    const kerf_ray from = ray();
    kerf_hit found;
    ASSERT_EQ(kerf_intersect_filtered(scene.c, &from, ~0u, even, nullptr, &found), KERF_OK);
    const auto expected =
        scene.cpp.intersect(as<kerf::Ray>(from), [](const kerf::Hit& hit) { return hit.primitive % 2 == 0; });
    ASSERT_EQ(as<kerf::Hit>(found), expected.value_or(kerf::Hit{}));
    int occluded;
    ASSERT_EQ(kerf_occluded_filtered(scene.c, &from, ~0u, even, nullptr, &occluded), KERF_OK);
    ASSERT_EQ(occluded, expected.has_value());
    ASSERT_EQ(kerf_intersect_filtered(scene.c, &from, 0, nullptr, nullptr, &found), KERF_OK);
    ASSERT_EQ(found.primitive, KERF_INVALID_ID);
  }
}

TEST_F(CInterface, OnePointIsAnsweredAsInCpp) {
  for (int i = 0; i < 200; ++i) {
    const auto at = point();
    const kerf::Vec3f to{at[0], at[1], at[2]};
    int inside;
    kerf_side side;
    float distance;
    kerf_surface_point closest;
    ASSERT_EQ(kerf_contains(scene.c, at.data(), &inside), KERF_OK);
    ASSERT_EQ(inside != 0, scene.cpp.contains(to));
    ASSERT_EQ(kerf_get_side(scene.c, at.data(), &side), KERF_OK);
    ASSERT_EQ(static_cast<int>(side), static_cast<int>(scene.cpp.side(to)));
    ASSERT_EQ(kerf_signed_distance(scene.c, at.data(), &distance), KERF_OK);
    ASSERT_EQ(distance, scene.cpp.signed_distance(to));
    ASSERT_EQ(kerf_closest_point(scene.c, at.data(), 0.5f, &closest), KERF_OK);
    ASSERT_EQ(as<kerf::SurfacePoint>(closest),
              scene.cpp.closest_point(to, 0.5f).value_or(kerf::SurfacePoint{}));
    std::vector<kerf_surface_point> list(1000);
    std::size_t count;
    ASSERT_EQ(kerf_within(scene.c, at.data(), 0.4f, list.data(), list.size(), &count), KERF_OK);
    ASSERT_EQ(as<kerf::SurfacePoint>(std::vector(list.begin(), list.begin() + static_cast<long>(count))),
              scene.cpp.within(to, 0.4f));
    ASSERT_EQ(kerf_nearest(scene.c, at.data(), 5, INFINITY, list.data(), list.size(), &count), KERF_OK);
    ASSERT_EQ(as<kerf::SurfacePoint>(std::vector(list.begin(), list.begin() + static_cast<long>(count))),
              scene.cpp.nearest(to, 5));
    const kerf_box box{{at[0], at[1], at[2]}, {at[0] + 0.3f, at[1] + 0.3f, at[2] + 0.3f}};
    std::vector<kerf_primitive_id> ids(5000);
    ASSERT_EQ(kerf_triangles_in(scene.c, &box, ids.data(), ids.size(), &count), KERF_OK);
    ids.resize(count);
    ASSERT_EQ(as<kerf::PrimitiveId>(ids), scene.cpp.triangles_in(as<kerf::Box3f>(box)));
  }
}

TEST_F(CInterface, ManyAreAnsweredAsOneByOne) {
  std::vector<kerf_ray> rays(1000);
  for (kerf_ray& each : rays) each = ray();
  const kerf_rays from = kerf_rays_of(rays.data(), rays.size());
  std::vector<kerf_hit> hits(rays.size());
  const kerf_hits to = kerf_hits_of(hits.data(), hits.size());
  std::vector<std::uint8_t> occluded(rays.size());
  std::vector<std::uint32_t> counts(rays.size());
  kerf_batch_options options = KERF_BATCH_OPTIONS_INIT;
  options.threads = 2;
  ASSERT_EQ(kerf_intersect_many(scene.c, &from, &to, &options), KERF_OK);
  ASSERT_EQ(kerf_occluded_many(scene.c, &from, occluded.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_count_hits_many(scene.c, &from, counts.data(), nullptr), KERF_OK);
  std::vector<std::size_t> offsets(rays.size() + 1);
  for (std::size_t i = 0; i < rays.size(); ++i) offsets[i + 1] = offsets[i] + counts[i];
  std::vector<kerf_hit> all(offsets.back());
  ASSERT_EQ(kerf_all_hits_many(scene.c, &from, offsets.data(), all.data(), all.size(), nullptr), KERF_OK);
  ASSERT_EQ(as<kerf::Hit>(all), scene.cpp.all_hits(as<kerf::Ray>(rays)).items);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    kerf_hit one;
    ASSERT_EQ(kerf_intersect(scene.c, &rays[i], &one), occluded[i]);
    ASSERT_EQ(as<kerf::Hit>(hits[i]), as<kerf::Hit>(one));
  }
  const auto odd = [](void*, std::size_t i, const kerf_hit*) { return static_cast<int>(i % 2); };
  ASSERT_EQ(kerf_intersect_many_filtered(scene.c, &from, odd, nullptr, &to, nullptr), KERF_OK);
  ASSERT_EQ(kerf_occluded_many_filtered(scene.c, &from, odd, nullptr, occluded.data(), nullptr), KERF_OK);
  for (std::size_t i = 0; i < rays.size(); i += 2) {
    ASSERT_EQ(hits[i].primitive, KERF_INVALID_ID);
    ASSERT_EQ(occluded[i], 0);
  }

  std::vector<float> points;
  std::vector<kerf_box> boxes;
  for (int i = 0; i < 500; ++i) {
    const auto at = point();
    points.insert(points.end(), at.begin(), at.end());
    boxes.push_back({{at[0], at[1], at[2]}, {at[0] + 0.2f, at[1] + 0.2f, at[2] + 0.2f}});
  }
  const kerf_points asked = kerf_points_of(points.data(), 500);
  std::vector<std::uint8_t> inside(500), sides(500);
  std::vector<float> distances(500);
  std::vector<kerf_surface_point> closest(500);
  ASSERT_EQ(kerf_contains_many(scene.c, &asked, inside.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_side_many(scene.c, &asked, sides.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_signed_distance_many(scene.c, &asked, distances.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_closest_point_many(scene.c, &asked, INFINITY, closest.data(), nullptr), KERF_OK);
  for (std::size_t i = 0; i < 500; ++i) {
    const kerf::Vec3f at{points[3 * i], points[3 * i + 1], points[3 * i + 2]};
    ASSERT_EQ(inside[i] != 0, scene.cpp.contains(at));
    ASSERT_EQ(sides[i], static_cast<int>(scene.cpp.side(at)));
    ASSERT_EQ(distances[i], scene.cpp.signed_distance(at));
    ASSERT_EQ(as<kerf::SurfacePoint>(closest[i]), scene.cpp.closest_point(at));
  }

  std::vector<std::size_t> ends(501);
  const kerf::TripleView<float> view(points);
  const auto within = scene.cpp.within(view, 0.3f);
  ASSERT_EQ(kerf_within_many(scene.c, &asked, 0.3f, ends.data(), nullptr, 0, nullptr), KERF_OK);
  ASSERT_EQ(ends, within.offsets);
  std::vector<kerf_surface_point> found(ends.back());
  ASSERT_EQ(kerf_within_many(scene.c, &asked, 0.3f, ends.data(), found.data(), found.size(), nullptr),
            KERF_OK);
  ASSERT_EQ(as<kerf::SurfacePoint>(found), within.items);
  found.resize(1000);
  ASSERT_EQ(kerf_nearest_many(scene.c, &asked, 2, INFINITY, ends.data(), found.data(), found.size(), nullptr),
            KERF_OK);
  ASSERT_EQ(as<kerf::SurfacePoint>(found), scene.cpp.nearest(view, 2).items);
  const auto in_boxes = scene.cpp.triangles_in(as<kerf::Box3f>(boxes));
  std::vector<kerf_primitive_id> ids(in_boxes.items.size());
  ASSERT_EQ(kerf_triangles_in_many(scene.c, boxes.data(), 500, ends.data(), ids.data(), ids.size(), nullptr),
            KERF_OK);
  ASSERT_EQ(ends, in_boxes.offsets);
  ASSERT_EQ(as<kerf::PrimitiveId>(ids), in_boxes.items);
}

TEST_F(CInterface, MeshesAreComparedWithMeshes) {
  const kerf_transform aside{{{1, 0, 0, 0.7}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  int touch;
  ASSERT_EQ(kerf_touches(scene.c, scene.c, &aside, &touch), KERF_OK);
  EXPECT_EQ(touch, 1);
  const auto expected = scene.cpp.touching_pairs(scene.cpp, as<kerf::Transform>(aside));
  std::size_t count;
  ASSERT_EQ(kerf_touching_pairs(scene.c, scene.c, &aside, nullptr, 0, &count), KERF_OK);
  std::vector<kerf_touching_pair> pairs(count);
  ASSERT_EQ(kerf_touching_pairs(scene.c, scene.c, &aside, pairs.data(), count, &count), KERF_OK);
  EXPECT_EQ(as<kerf::TouchingPair>(pairs), expected);
}

TEST_F(CInterface, HierarchiesAreSavedSharedAndMeasured) {
  const std::string path = ::testing::TempDir() + "kerf_c_interface.kerf";
  ASSERT_EQ(kerf_save(scene.c, path.c_str()), KERF_OK) << kerf_last_error();
  kerf_bvh *loaded, *mapped;
  ASSERT_EQ(kerf_load(path.c_str(), &loaded), KERF_OK) << kerf_last_error();
  ASSERT_EQ(kerf_map(path.c_str(), &mapped), KERF_OK) << kerf_last_error();
  std::remove(path.c_str());
  kerf_bvh* const shared = kerf_bvh_retain(mapped);
  kerf_bvh_release(mapped);
  std::thread([&] {
    kerf_ray from = ray();
    from.origin[0] = from.origin[1] = from.origin[2] = 0.0f;
    kerf_hit a, b;
    EXPECT_EQ(kerf_intersect(loaded, &from, &a), 1);
    EXPECT_EQ(kerf_intersect(shared, &from, &b), 1);
    EXPECT_EQ(as<kerf::Hit>(a), as<kerf::Hit>(b));
  }).join();
  kerf_bvh_release(shared);
  kerf_bvh_release(loaded);
  kerf_bvh_release(nullptr);

  kerf_statistics statistics = KERF_STATISTICS_INIT;
  ASSERT_EQ(kerf_get_statistics(scene.c, &statistics), KERF_OK);
  EXPECT_EQ(statistics.triangles, scene.cpp.statistics().triangles);
  EXPECT_EQ(statistics.bytes, scene.cpp.statistics().bytes);
  kerf_mesh_statistics mesh;
  std::size_t count;
  ASSERT_EQ(kerf_get_mesh_statistics(scene.c, &mesh, 1, &count), KERF_OK);
  EXPECT_EQ(count, 1u);
  EXPECT_EQ(mesh.references, statistics.references);
  EXPECT_EQ(as<kerf::Box3f>(kerf_bounds(scene.c)), scene.cpp.bounds());
  kerf_triangle triangle;
  int found;
  ASSERT_EQ(kerf_get_triangle(scene.c, {0, 0}, &triangle, &found), KERF_OK);
  EXPECT_EQ(found, 1);
  EXPECT_EQ(triangle.v0[2], 1.0f);
  ASSERT_EQ(kerf_get_triangle(scene.c, {1u << 30, 0}, &triangle, &found), KERF_OK);
  EXPECT_EQ(found, 0);
}

TEST_F(CInterface, ARefitAnswersAsANewBuildAndLeavesOtherOwnersAlone) {
  kerf_bvh* mine = nullptr;
  const kerf_mesh view = scene.mesh();
  ASSERT_EQ(kerf_build(&view, 1, nullptr, &mine), KERF_OK);
  const kerf_bvh* const before = mine;
  for (std::size_t i = 0; i < scene.vertices.size(); ++i)
    scene.vertices[i] += 0.2f * std::sin(static_cast<float>(i));
  kerf_refit_report report = KERF_REFIT_REPORT_INIT;
  const kerf_mesh bent = scene.mesh();
  ASSERT_EQ(kerf_refit(&mine, &bent, 1, nullptr, &report), KERF_OK) << kerf_last_error();
  EXPECT_EQ(mine, before) << "the only owner keeps its handle";
  EXPECT_GT(report.cost_ratio, 1.0);
  EXPECT_EQ(report.rebuilt, 0);

  kerf_bvh* shared = kerf_bvh_retain(scene.c);
  ASSERT_EQ(kerf_refit(&shared, &bent, 1, nullptr, nullptr), KERF_OK);
  EXPECT_NE(shared, scene.c);
  const kerf::Bvh built = kerf::build({.vertices = scene.vertices, .triangles = scene.triangles});
  for (int i = 0; i < 300; ++i) {
    const kerf_ray from = ray();
    const auto expected = built.intersect(as<kerf::Ray>(from)).value_or(kerf::Hit{});
    kerf_hit hit;
    kerf_intersect(mine, &from, &hit);
    ASSERT_EQ(as<kerf::Hit>(hit), expected);
    kerf_intersect(shared, &from, &hit);
    ASSERT_EQ(as<kerf::Hit>(hit), expected);
    kerf_intersect(scene.c, &from, &hit);
    ASSERT_EQ(as<kerf::Hit>(hit), scene.cpp.intersect(as<kerf::Ray>(from)).value_or(kerf::Hit{}));
  }
  kerf_mesh shorter = bent;
  shorter.triangle_count -= 1;
  EXPECT_EQ(kerf_refit(&mine, &shorter, 1, nullptr, nullptr), KERF_INVALID_ARGUMENT);
  EXPECT_NE(std::string(kerf_last_error()).find("triangles"), std::string::npos) << kerf_last_error();
  report.struct_size = 0;
  EXPECT_EQ(kerf_refit(&mine, &bent, 1, nullptr, &report), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(mine, before);
  EXPECT_EQ(kerf_refit(nullptr, &bent, 1, nullptr, nullptr), KERF_INVALID_ARGUMENT);
  kerf_bvh* none = nullptr;
  EXPECT_EQ(kerf_refit(&none, &bent, 1, nullptr, nullptr), KERF_INVALID_ARGUMENT);
  kerf_bvh_release(mine);
  kerf_bvh_release(shared);
}

TEST_F(CInterface, CallsRunOnThePoolThatIsGiven) {
  // Each task on a thread of its own; every third is refused.
  struct Threads {
    std::mutex mutex;
    std::vector<std::thread> started;
    int asked = 0;
  } threads;
  kerf_thread_pool pool = KERF_THREAD_POOL_INIT;
  pool.context = &threads;
  pool.threads = [](void*) { return 4u; };
  pool.start = [](void* context, void (*task)(void*), void* data) {
    auto& all = *static_cast<Threads*>(context);
    const std::lock_guard lock(all.mutex);
    if (++all.asked % 3 == 0) return 0;
    all.started.emplace_back([=] { task(data); });
    return 1;
  };
  struct Asked {
    const kerf_bvh* bvh;
    std::vector<kerf_ray> rays;
    std::vector<kerf_hit> hits;
    kerf_status status = KERF_INTERNAL;
  } asked{scene.c, std::vector<kerf_ray>(20000), std::vector<kerf_hit>(20000)};
  for (kerf_ray& each : asked.rays) each = ray();
  const auto work = [](void* context) {
    auto& all = *static_cast<Asked*>(context);
    const kerf_rays from = kerf_rays_of(all.rays.data(), all.rays.size());
    const kerf_hits to = kerf_hits_of(all.hits.data(), all.hits.size());
    all.status = kerf_intersect_many(all.bvh, &from, &to, nullptr);
  };
  ASSERT_EQ(kerf_run_on(&pool, work, &asked), KERF_OK) << kerf_last_error();
  ASSERT_EQ(asked.status, KERF_OK);
  for (std::thread& each : threads.started) each.join();
  EXPECT_GT(threads.asked, 0);
  for (std::size_t i = 0; i < asked.rays.size(); ++i) {
    ASSERT_EQ(as<kerf::Hit>(asked.hits[i]),
              scene.cpp.intersect(as<kerf::Ray>(asked.rays[i])).value_or(kerf::Hit{}));
  }
  EXPECT_EQ(kerf_run_on(nullptr, work, &asked), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_run_on(&pool, nullptr, &asked), KERF_INVALID_ARGUMENT);
  pool.threads = nullptr;
  EXPECT_EQ(kerf_run_on(&pool, work, &asked), KERF_INVALID_ARGUMENT);
}

// Scenes of the test's sphere under transforms of all kinds, one of them in the other.
class CScene : public CInterface {
 protected:
  void SetUp() override {
    CInterface::SetUp();
    std::vector<kerf_instance> given;
    std::vector<kerf::Instance> instances;
    const double pi = 3.14159265358979;
    for (std::uint32_t i = 0; i < 12; ++i) {
      const double c = std::cos(pi * i / 6), s = std::sin(pi * i / 6), size = 0.2 + 0.02 * i;
      kerf_instance instance = KERF_INSTANCE_INIT;
      instance.object = scene.c;
      instance.transform = {
          {{size * c, -size * s, 0, c}, {size * s, size * c, 0.1, s}, {0, 0, 2 * size, 0.1 * i}}};
      instance.mask = 1u << (i % 3);
      instance.number = 100 + i;
      given.push_back(instance);
      instances.push_back({.object = scene.cpp,
                           .transform = as<kerf::Transform>(instance.transform),
                           .mask = {instance.mask},
                           .number = instance.number});
    }
    ASSERT_EQ(kerf_build_scene(given.data(), given.size(), nullptr, &ring), KERF_OK) << kerf_last_error();
    const kerf::Scene cpp_ring = kerf::build(instances);
    std::vector<kerf_instance> rings(2, kerf_instance KERF_INSTANCE_INIT);
    rings[0].scene = rings[1].scene = ring;
    rings[1].transform.rows[2][3] = -0.7;
    ASSERT_EQ(kerf_build_scene(rings.data(), rings.size(), nullptr, &both), KERF_OK) << kerf_last_error();
    cpp = kerf::build(std::vector<kerf::Instance>{
        {.scene = cpp_ring}, {.scene = cpp_ring, .transform = as<kerf::Transform>(rings[1].transform)}});
  }
  void TearDown() override {
    kerf_scene_release(both);
    kerf_scene_release(ring);
  }

  kerf_scene *ring = nullptr, *both = nullptr;
  kerf::Scene cpp;
};

TEST_F(CScene, OneRayAndOnePointAreAnsweredAsInCpp) {
  int hits = 0, inside_count = 0;
  for (int i = 0; i < 300; ++i) {
    const kerf_ray from = ray();
    const auto to = as<kerf::Ray>(from);
    const kerf::SceneHit hit = cpp.intersect(to).value_or(kerf::SceneHit{});
    hits += bool(hit);
    kerf_scene_hit found;
    ASSERT_EQ(kerf_scene_intersect(both, &from, &found), int(bool(hit)));
    ASSERT_EQ(as<kerf::SceneHit>(found), hit);
    ASSERT_EQ(kerf_scene_occluded(both, &from), int(bool(hit)));
    ASSERT_EQ(kerf_scene_intersect_masked(both, &from, 2, &found), KERF_OK);
    ASSERT_EQ(as<kerf::SceneHit>(found), cpp.intersect(to, kerf::Mask{2}).value_or(kerf::SceneHit{}));
    int occluded;
    ASSERT_EQ(kerf_scene_occluded_masked(both, &from, 2, &occluded), KERF_OK);
    ASSERT_EQ(occluded != 0, found.instance != KERF_INVALID_ID);
    if (hit) {
      const auto first = std::bit_cast<kerf_scene_hit>(hit);
      kerf_hit_geometry geometry;
      ASSERT_EQ(kerf_scene_get_geometry(both, &from, &first, &geometry), KERF_OK);
      const kerf::HitGeometry in_cpp = cpp.geometry(to, hit);
      ASSERT_EQ(as<kerf::Triangle>(geometry.triangle), in_cpp.triangle);
      ASSERT_EQ(geometry.normal[1], in_cpp.normal.y);
      ASSERT_EQ(geometry.front != 0, in_cpp.front);
      kerf_triangle triangle;
      int is_there;
      ASSERT_EQ(kerf_scene_get_triangle(both, {hit.primitive, hit.mesh, hit.instance}, &triangle, &is_there),
                KERF_OK);
      ASSERT_EQ(as<kerf::Triangle>(triangle), in_cpp.triangle);
      ASSERT_EQ(kerf_scene_get_triangle(both, {hit.primitive, 7, hit.instance}, &triangle, &is_there),
                KERF_OK);
      ASSERT_EQ(is_there, 0);
    }
    const auto odd = [](void*, const kerf_scene_hit* each) {
      return static_cast<int>((each->primitive + each->instance) % 2);
    };
    ASSERT_EQ(kerf_scene_intersect_filtered(both, &from, 3, odd, nullptr, &found), KERF_OK);
    ASSERT_EQ(as<kerf::SceneHit>(found), cpp.intersect(to, kerf::Mask{3},
                                                       [](const kerf::SceneHit& each) {
                                                         return (each.primitive + each.instance) % 2 != 0;
                                                       })
                                             .value_or(kerf::SceneHit{}));
    ASSERT_EQ(kerf_scene_occluded_filtered(both, &from, 3, odd, nullptr, &occluded), KERF_OK);
    ASSERT_EQ(occluded != 0, found.instance != KERF_INVALID_ID);
    ASSERT_EQ(kerf_scene_intersect_filtered(both, &from, 2, nullptr, nullptr, &found), KERF_OK);
    ASSERT_EQ(as<kerf::SceneHit>(found), cpp.intersect(to, kerf::Mask{2}).value_or(kerf::SceneHit{}));
    ASSERT_EQ(kerf_scene_occluded_filtered(both, &from, 2, nullptr, nullptr, &occluded), KERF_OK);
    ASSERT_EQ(occluded != 0, found.instance != KERF_INVALID_ID);
    std::vector<kerf::SceneHit> expected;
    cpp.all_hits(to, [&](const kerf::SceneHit& crossing) { expected.push_back(crossing); });
    std::vector<kerf_scene_hit> all(expected.size());
    std::size_t count = 0;
    ASSERT_EQ(kerf_scene_all_hits(both, &from, all.data(), all.size(), &count), KERF_OK);
    ASSERT_EQ(as<kerf::SceneHit>(all), expected);
    ASSERT_EQ(count, expected.size());
    ASSERT_EQ(kerf_scene_count_hits(both, &from, &count), KERF_OK);
    ASSERT_EQ(count, expected.size());

    const auto at = point();
    const kerf::Vec3f place{at[0], at[1], at[2]};
    int inside;
    float distance;
    kerf_scene_point closest;
    ASSERT_EQ(kerf_scene_contains(both, at.data(), &inside), KERF_OK);
    ASSERT_EQ(inside != 0, cpp.contains(place));
    inside_count += inside;
    kerf_side side;
    ASSERT_EQ(kerf_scene_get_side(both, at.data(), &side), KERF_OK);
    ASSERT_EQ(side, static_cast<kerf_side>(cpp.side(place)));
    ASSERT_EQ(kerf_scene_signed_distance(both, at.data(), &distance), KERF_OK);
    ASSERT_EQ(distance, cpp.signed_distance(place));
    ASSERT_EQ(kerf_scene_closest_point(both, at.data(), 0.2f, &closest), KERF_OK);
    ASSERT_EQ(as<kerf::ScenePoint>(closest), cpp.closest_point(place, 0.2f).value_or(kerf::ScenePoint{}));
    std::vector<kerf_scene_point> list(100000);
    ASSERT_EQ(kerf_scene_nearest(both, at.data(), 4, 0.5f, list.data(), list.size(), &count), KERF_OK);
    ASSERT_EQ(
        as<kerf::ScenePoint>(std::vector(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count))),
        cpp.nearest(place, 4, 0.5f));
    ASSERT_EQ(kerf_scene_within(both, at.data(), 0.2f, list.data(), list.size(), &count), KERF_OK);
    list.resize(count);
    ASSERT_EQ(as<kerf::ScenePoint>(list), cpp.within(place, 0.2f));
    const kerf_box box = {{at[0], at[1], at[2]}, {at[0] + 0.2f, at[1] + 0.2f, at[2] + 0.2f}};
    const auto in_box = cpp.triangles_in(as<kerf::Box3f>(box));
    std::vector<kerf_scene_primitive_id> ids(in_box.size());
    ASSERT_EQ(kerf_scene_triangles_in(both, &box, ids.data(), ids.size(), &count), KERF_OK);
    ASSERT_EQ(count, in_box.size());
    ASSERT_EQ(as<kerf::ScenePrimitiveId>(ids), in_box);
  }
  EXPECT_GT(hits, 30);
  EXPECT_GT(inside_count, 3);
}

TEST_F(CScene, ManyAreAnsweredAsOneByOne) {
  std::vector<kerf_ray> rays(500);
  std::vector<float> points;
  for (kerf_ray& each : rays) {
    each = ray();
    points.insert(points.end(), each.origin, each.origin + 3);
  }
  const kerf_rays from = kerf_rays_of(rays.data(), rays.size());
  const kerf_points asked = kerf_points_of(points.data(), rays.size());
  std::vector<kerf_scene_hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size()), inside(rays.size()), sides(rays.size());
  std::vector<std::uint32_t> counts(rays.size());
  std::vector<float> distances(rays.size());
  std::vector<kerf_scene_point> closest(rays.size());
  std::vector<std::size_t> offsets(rays.size() + 1);
  kerf_batch_options options = KERF_BATCH_OPTIONS_INIT;
  options.threads = 2;
  ASSERT_EQ(kerf_scene_intersect_many(both, &from, hits.data(), &options), KERF_OK);
  ASSERT_EQ(kerf_scene_occluded_many(both, &from, occluded.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_scene_count_hits_many(both, &from, counts.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_scene_contains_many(both, &asked, inside.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_scene_side_many(both, &asked, sides.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_scene_signed_distance_many(both, &asked, distances.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_scene_closest_point_many(both, &asked, 0.3f, closest.data(), nullptr), KERF_OK);
  const auto all = cpp.all_hits(as<kerf::Ray>(rays));
  ASSERT_EQ(kerf_scene_all_hits_many(both, &from, offsets.data(), nullptr, 0, nullptr), KERF_OK);
  ASSERT_EQ(offsets, all.offsets);
  std::vector<kerf_scene_hit> listed(offsets.back());
  ASSERT_EQ(kerf_scene_all_hits_many(both, &from, offsets.data(), listed.data(), listed.size(), nullptr),
            KERF_OK);
  ASSERT_EQ(as<kerf::SceneHit>(listed), all.items);
  const auto nearest = cpp.nearest(kerf::TripleView<float>(points), 3, 0.4f);
  std::vector<kerf_scene_point> nearby(nearest.items.size());
  ASSERT_EQ(
      kerf_scene_nearest_many(both, &asked, 3, 0.4f, offsets.data(), nearby.data(), nearby.size(), nullptr),
      KERF_OK);
  ASSERT_EQ(offsets, nearest.offsets);
  ASSERT_EQ(as<kerf::ScenePoint>(nearby), nearest.items);
  const auto within = cpp.within(kerf::TripleView<float>(points), 0.1f);
  std::vector<kerf_scene_point> found(within.items.size());
  ASSERT_EQ(kerf_scene_within_many(both, &asked, 0.1f, offsets.data(), found.data(), found.size(), nullptr),
            KERF_OK);
  ASSERT_EQ(offsets, within.offsets);
  ASSERT_EQ(as<kerf::ScenePoint>(found), within.items);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto to = as<kerf::Ray>(rays[i]);
    ASSERT_EQ(as<kerf::SceneHit>(hits[i]), cpp.intersect(to).value_or(kerf::SceneHit{}));
    ASSERT_EQ(occluded[i] != 0, cpp.occluded(to));
    ASSERT_EQ(counts[i], cpp.count_hits(to));
    ASSERT_EQ(inside[i] != 0, cpp.contains(to.origin));
    ASSERT_EQ(sides[i], static_cast<std::uint8_t>(cpp.side(to.origin)));
    ASSERT_EQ(distances[i], cpp.signed_distance(to.origin));
    ASSERT_EQ(as<kerf::ScenePoint>(closest[i]),
              cpp.closest_point(to.origin, 0.3f).value_or(kerf::ScenePoint{}));
  }
  std::vector<kerf_box> boxes;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float* const at = points.data() + 3 * i;
    boxes.push_back({{at[0], at[1], at[2]}, {at[0] + 0.3f, at[1] + 0.2f, at[2] + 0.1f}});
  }
  const auto in_boxes = cpp.triangles_in(as<kerf::Box3f>(boxes));
  std::vector<kerf_scene_primitive_id> ids(in_boxes.items.size());
  ASSERT_EQ(kerf_scene_triangles_in_many(both, boxes.data(), boxes.size(), offsets.data(), ids.data(),
                                         ids.size(), nullptr),
            KERF_OK);
  ASSERT_EQ(offsets, in_boxes.offsets);
  ASSERT_EQ(as<kerf::ScenePrimitiveId>(ids), in_boxes.items);
  const auto odd = [](void*, std::size_t i, const kerf_scene_hit* each) {
    return static_cast<int>((i + each->primitive) % 2);
  };
  ASSERT_EQ(kerf_scene_intersect_many_filtered(both, &from, odd, nullptr, hits.data(), nullptr), KERF_OK);
  ASSERT_EQ(kerf_scene_occluded_many_filtered(both, &from, odd, nullptr, occluded.data(), nullptr), KERF_OK);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto expected = cpp.intersect(
        as<kerf::Ray>(rays[i]), [&](const kerf::SceneHit& each) { return (i + each.primitive) % 2 != 0; });
    ASSERT_EQ(as<kerf::SceneHit>(hits[i]), expected.value_or(kerf::SceneHit{}));
    ASSERT_EQ(occluded[i] != 0, expected.has_value());
  }
  EXPECT_EQ(kerf_scene_intersect_many_filtered(both, &from, nullptr, nullptr, hits.data(), nullptr),
            KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_scene_occluded_many_filtered(both, &from, nullptr, nullptr, occluded.data(), nullptr),
            KERF_INVALID_ARGUMENT);
  // Each ray with its own mask.
  kerf_rays masked = from;
  const std::uint32_t bits = 4;
  masked.mask = {&bits, 0};
  ASSERT_EQ(kerf_scene_intersect_many(both, &masked, hits.data(), nullptr), KERF_OK);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(as<kerf::SceneHit>(hits[i]),
              cpp.intersect(as<kerf::Ray>(rays[i]), kerf::Mask{4}).value_or(kerf::SceneHit{}));
  }
}

TEST_F(CScene, TouchingPairsAreThoseOfCpp) {
  const kerf_transform aside = {{{1, 0, 0, 0.3}, {0, 1, 0, 0}, {0, 0, 1, 0.2}}};
  const auto pairs_of = [&](const kerf_scene* other, const kerf_transform* transform) {
    std::size_t count = 0;
    EXPECT_EQ(kerf_scene_touching_pairs(both, other, transform, nullptr, 0, &count), KERF_OK);
    std::vector<kerf_scene_touching_pair> pairs(count);
    EXPECT_EQ(kerf_scene_touching_pairs(both, other, transform, pairs.data(), count, &count), KERF_OK);
    return as<kerf::SceneTouchingPair>(pairs);
  };
  const kerf::Scene row = cpp.instances()[0].scene;
  const auto expected = cpp.touching_pairs(row, as<kerf::Transform>(aside));
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(pairs_of(ring, &aside), expected);
  EXPECT_FALSE(cpp.touching_pairs().empty());
  EXPECT_EQ(pairs_of(nullptr, nullptr), cpp.touching_pairs());
  int touch;
  ASSERT_EQ(kerf_scene_touches(both, ring, &aside, &touch), KERF_OK);
  EXPECT_EQ(touch, 1);
  std::size_t count;
  EXPECT_EQ(kerf_scene_touching_pairs(both, nullptr, &aside, nullptr, 0, &count), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_scene_touches(both, nullptr, nullptr, &touch), KERF_INVALID_ARGUMENT);
}

TEST_F(CScene, ScenesAreSavedWithTheHandlesInThem) {
  const std::string path = ::testing::TempDir() + "kerf_c_scene.kerf";
  ASSERT_EQ(kerf_scene_save(both, path.c_str()), KERF_OK) << kerf_last_error();
  kerf_scene *loaded, *mapped;
  ASSERT_EQ(kerf_scene_load(path.c_str(), &loaded), KERF_OK) << kerf_last_error();
  ASSERT_EQ(kerf_scene_map(path.c_str(), &mapped), KERF_OK) << kerf_last_error();
  std::remove(path.c_str());
  for (int i = 0; i < 200; ++i) {
    const kerf_ray from = ray();
    kerf_scene_hit expected, hit;
    kerf_scene_intersect(both, &from, &expected);
    for (const kerf_scene* const scene_again : {loaded, mapped}) {
      kerf_scene_intersect(scene_again, &from, &hit);
      ASSERT_EQ(as<kerf::SceneHit>(hit), as<kerf::SceneHit>(expected));
    }
  }
  kerf_instance rows[2] = {KERF_INSTANCE_INIT, KERF_INSTANCE_INIT}, first = KERF_INSTANCE_INIT,
                last = KERF_INSTANCE_INIT;
  ASSERT_EQ(kerf_scene_get_instance(loaded, 0, &rows[0]), KERF_OK);
  ASSERT_EQ(kerf_scene_get_instance(loaded, 1, &rows[1]), KERF_OK);
  EXPECT_EQ(rows[0].scene, rows[1].scene);
  EXPECT_EQ(rows[1].transform.rows[2][3], -0.7);
  ASSERT_EQ(kerf_scene_get_instance(rows[0].scene, 0, &first), KERF_OK);
  ASSERT_EQ(kerf_scene_get_instance(rows[0].scene, 11, &last), KERF_OK);
  EXPECT_EQ(first.object, last.object);
  EXPECT_EQ(last.number, 111u);
  EXPECT_EQ(last.mask, 4u);
  kerf_scene* const kept = kerf_scene_retain(rows[0].scene);
  kerf_scene_release(loaded);
  EXPECT_EQ(kerf_scene_instance_count(kept), 12u);
  kerf_scene_release(kept);
  kerf_scene_release(mapped);
  kerf_scene* none = mapped;
  EXPECT_EQ(kerf_scene_load(path.c_str(), &none), KERF_IO);
  EXPECT_EQ(none, nullptr);
}

TEST_F(CScene, InstancesAreNamedAndKeptAsLongAsTheScene) {
  EXPECT_EQ(kerf_scene_instance_count(both), 24u);
  std::uint32_t path[2];
  std::size_t count;
  ASSERT_EQ(kerf_scene_path(both, 17, path, 2, &count), KERF_OK);
  EXPECT_EQ(count, 2u);
  EXPECT_EQ(path[0], 1u);
  EXPECT_EQ(path[1], 5u);
  EXPECT_EQ(kerf_scene_path(both, 24, path, 2, &count), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(as<kerf::Box3f>(kerf_scene_bounds(both)), cpp.bounds());
  EXPECT_EQ(kerf_scene_bytes(both), cpp.bytes());

  kerf_scene_release(ring);  // `both` is its owner still
  ring = nullptr;
  kerf_instance row = KERF_INSTANCE_INIT, one = KERF_INSTANCE_INIT;
  ASSERT_EQ(kerf_scene_get_instance(both, 1, &row), KERF_OK);
  EXPECT_EQ(row.object, nullptr);
  ASSERT_EQ(kerf_scene_get_instance(row.scene, 5, &one), KERF_OK);
  EXPECT_EQ(one.object, scene.c);
  EXPECT_EQ(one.number, 105u);
  EXPECT_EQ(kerf_scene_get_instance(both, 2, &one), KERF_INVALID_ARGUMENT);

  kerf_bvh* bent = kerf_bvh_retain(scene.c);
  for (float& x : scene.vertices) x *= 1.5f;
  const kerf_mesh view = scene.mesh();
  ASSERT_EQ(kerf_refit(&bent, &view, 1, nullptr, nullptr), KERF_OK);
  EXPECT_NE(bent, scene.c) << "a scene stands on it";
  EXPECT_EQ(as<kerf::Box3f>(kerf_scene_bounds(both)), cpp.bounds());
  kerf_bvh_release(bent);
}

TEST_F(CScene, WhatCannotBeAnInstanceIsRefusedWithASentence) {
  kerf_scene* made = ring;
  kerf_instance instance = KERF_INSTANCE_INIT;
  const auto refused = [&](const char* word) {
    EXPECT_EQ(kerf_build_scene(&instance, 1, nullptr, &made), KERF_INVALID_ARGUMENT);
    EXPECT_EQ(made, nullptr);
    EXPECT_NE(std::string(kerf_last_error()).find(word), std::string::npos) << kerf_last_error();
    instance = KERF_INSTANCE_INIT;
    instance.object = scene.c;
  };
  refused("an object or a scene");
  instance.scene = ring;
  refused("an object or a scene");
  instance.transform.rows[1][1] = NAN;
  refused("finite");
  instance.transform.rows[2][2] = 0;
  refused("flattens");
  instance.struct_size = 3;
  refused("struct_size");
  EXPECT_EQ(kerf_build_scene(&instance, 1, nullptr, nullptr), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_build_scene(nullptr, 1, nullptr, &made), KERF_INVALID_ARGUMENT);
  ASSERT_EQ(kerf_build_scene(nullptr, 0, nullptr, &made), KERF_OK);
  const kerf_ray from = ray();
  EXPECT_EQ(kerf_scene_occluded(made, &from), 0);
  kerf_scene_release(made);
  kerf_scene_release(nullptr);
  EXPECT_EQ(kerf_scene_contains(ring, nullptr, nullptr), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_scene_intersect_many(nullptr, nullptr, nullptr, nullptr), KERF_INVALID_ARGUMENT);
}

TEST_F(CInterface, DoublesAreBuiltInALocalFrame) {
  const double place[3] = {500000.25, 4600000.5, 100.125};
  std::vector<double> vertices;
  for (std::size_t i = 0; i < scene.vertices.size(); ++i)
    vertices.push_back(scene.vertices[i] + place[i % 3]);
  const std::vector<std::uint64_t> wide(scene.triangles.begin(), scene.triangles.end());
  kerf_double_mesh mesh = KERF_DOUBLE_MESH_INIT;
  mesh.vertices = vertices.data();
  mesh.vertex_count = vertices.size() / 3;
  mesh.triangles = wide.data();
  mesh.triangle_count = wide.size() / 3;
  mesh.index_bits = 64;
  kerf_bvh* bvh;
  ASSERT_EQ(kerf_build_double(&mesh, 1, nullptr, &bvh), KERF_OK) << kerf_last_error();
  float local[3];
  kerf_to_local(bvh, place, local);
  double back[3], origin[3];
  kerf_from_local(bvh, local, back);
  kerf_origin(bvh, origin);
  EXPECT_NE(origin[0], 0.0);
  EXPECT_NEAR(back[1], place[1], 1e-6);
  float distance;
  ASSERT_EQ(kerf_signed_distance(bvh, local, &distance), KERF_OK);
  EXPECT_NEAR(distance, -1.0f, 0.02f);
  kerf_bvh_release(bvh);
}

TEST_F(CInterface, WhatCannotBeRightIsRefusedWithASentence) {
  kerf_bvh* bvh = scene.c;
  kerf_mesh mesh = scene.mesh();
  const auto refused = [&](kerf_status expected, const char* word) {
    EXPECT_EQ(kerf_build(&mesh, 1, nullptr, &bvh), expected);
    EXPECT_EQ(bvh, nullptr);
    EXPECT_NE(std::string(kerf_last_error()).find(word), std::string::npos) << kerf_last_error();
    mesh = scene.mesh();
  };
  mesh.struct_size = 0;
  refused(KERF_INVALID_ARGUMENT, "struct_size");
  mesh.vertices = nullptr;
  refused(KERF_INVALID_ARGUMENT, "no vertices");
  mesh.vertex_count = 3;
  refused(KERF_INDEX_OUT_OF_RANGE, "vertex");
  scene.vertices[0] = NAN;
  refused(KERF_NON_FINITE_VERTEX, "vertex");
  kerf_build_options options = KERF_BUILD_OPTIONS_INIT;
  options.non_finite = KERF_SKIP;
  ASSERT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_OK) << kerf_last_error();
  kerf_bvh_release(bvh);
  scene.vertices[0] = 0.0f;
  options.alpha = 2.0f;
  EXPECT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_INVALID_ARGUMENT);
  options = KERF_BUILD_OPTIONS_INIT;
  options.builder = 7;
  EXPECT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_INVALID_ARGUMENT);
  options = KERF_BUILD_OPTIONS_INIT;
  options.quality = 3;
  EXPECT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_INVALID_ARGUMENT);
  options.quality = KERF_BEST;
  options.max_refinement_seconds = -1.0;
  EXPECT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_INVALID_ARGUMENT);
  options.max_refinement_seconds = 1.0;
  ASSERT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_OK) << kerf_last_error();
  kerf_bvh_release(bvh);
  options.sample_ray_count = 1;
  EXPECT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_INVALID_ARGUMENT);
  const kerf_ray down{{0.2f, 0.2f, 1.0f}, {0.0f, 0.0f, -1.0f}, 0.0f, 2.0f};
  options.sample_rays = &down;
  ASSERT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_OK) << kerf_last_error();
  kerf_bvh_release(bvh);
  options = KERF_BUILD_OPTIONS_INIT;
  options.progress = [](void*, float) { return 0; };
  EXPECT_EQ(kerf_build(&mesh, 1, &options, &bvh), KERF_CANCELLED);

  EXPECT_EQ(kerf_build(&mesh, 1, nullptr, nullptr), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_build(nullptr, 1, nullptr, &bvh), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_load(nullptr, &bvh), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_load("no such file.kerf", &bvh), KERF_IO);
  EXPECT_EQ(bvh, nullptr);
  EXPECT_EQ(kerf_contains(scene.c, nullptr, nullptr), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_contains(nullptr, scene.vertices.data(), nullptr), KERF_INVALID_ARGUMENT);
  const kerf_rays none = kerf_rays_of(nullptr, 7);
  EXPECT_EQ(none.count, 0u);
  EXPECT_EQ(kerf_occluded_many(scene.c, &none, nullptr, nullptr), KERF_OK);
  const kerf_ray one{};
  const kerf_rays from = kerf_rays_of(&one, 1);
  const kerf_hits to = kerf_hits_of(nullptr, 0);
  EXPECT_EQ(kerf_intersect_many(scene.c, &from, &to, nullptr), KERF_INVALID_ARGUMENT);
  std::string other_threads_error = "?";
  std::thread([&] { other_threads_error = kerf_last_error(); }).join();
  EXPECT_EQ(other_threads_error, "");
}

TEST_F(CInterface, TheMemoryOfABuildIsKnownBefore) {
  kerf_build_options options = KERF_BUILD_OPTIONS_INIT;
  options.max_reference_ratio = 3.0f;
  std::size_t bytes = 0, more = 0;
  ASSERT_EQ(kerf_build_memory_bound(1000, nullptr, &bytes), KERF_OK);
  EXPECT_EQ(bytes, kerf::build_memory_bound(1000));
  ASSERT_EQ(kerf_build_memory_bound(1000, &options, &more), KERF_OK);
  EXPECT_EQ(more, kerf::build_memory_bound(1000, {.max_reference_ratio = 3.0f}));
  EXPECT_GT(more, bytes);
  options.max_reference_ratio = 0.0f;
  EXPECT_EQ(kerf_build_memory_bound(1000, &options, &more), KERF_INVALID_ARGUMENT);
  EXPECT_EQ(kerf_build_memory_bound(1000, nullptr, nullptr), KERF_INVALID_ARGUMENT);
}

// A program that was compiled with a later header, or with an earlier one.
TEST_F(CInterface, StructsOfOtherVersionsAreUnderstood) {
  struct Later {
    kerf_batch_options known = KERF_BATCH_OPTIONS_INIT;
    std::uint64_t unknown = 0;
  } later;
  later.known.struct_size = sizeof later;
  const kerf_ray one{{0, 0, 0}, {1, 0.1f, 0.2f}, 0, 10};
  const kerf_rays from = kerf_rays_of(&one, 1);
  std::uint8_t occluded = 0;
  EXPECT_EQ(kerf_occluded_many(scene.c, &from, &occluded, &later.known), KERF_OK);
  EXPECT_EQ(occluded, 1);
  later.unknown = 1;
  EXPECT_EQ(kerf_occluded_many(scene.c, &from, &occluded, &later.known), KERF_INVALID_ARGUMENT);
  EXPECT_NE(std::string(kerf_last_error()).find("does not know"), std::string::npos);

  later.known.struct_size = sizeof(kerf_batch_options) - 1;
  EXPECT_EQ(kerf_occluded_many(scene.c, &from, &occluded, &later.known), KERF_INVALID_ARGUMENT);
  EXPECT_NE(std::string(kerf_last_error()).find("struct_size"), std::string::npos);

  kerf_statistics earlier = KERF_STATISTICS_INIT;
  earlier.struct_size = offsetof(kerf_statistics, degenerate_triangles);
  earlier.degenerate_triangles = 77;
  ASSERT_EQ(kerf_get_statistics(scene.c, &earlier), KERF_OK);
  EXPECT_EQ(earlier.triangles, scene.cpp.statistics().triangles);
  EXPECT_EQ(earlier.degenerate_triangles, 77u) << "written beyond the caller's struct";
}

}  // namespace
