// The code that kernels run, on the host: bit for bit what the library answers.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kerf::cuda {
namespace {

struct Named {
  const char* name;
  HostHierarchy hierarchy;
};
// One after another as the device would hold it: uploaded from a tree, from a layout, and built there.
std::vector<Named> hierarchies(std::span<const TriangleMesh> meshes, const Tree& tree, const Bvh& bvh) {
  const Layout arrays = layout(bvh);
  const std::vector<std::uint32_t> firsts(arrays.first_triangles.begin(), arrays.first_triangles.end());
  std::vector<Named> result;
  result.push_back({"tree", uploaded(source_of(tree), firsts)});
  result.push_back({"layout", uploaded(source_of(arrays), firsts)});
  result.push_back({"built", built(meshes, {})});
  result.push_back({"built without splits", built(meshes, {.max_reference_ratio = 1.0f})});
  result.push_back({"built of twice as many",
                    built(meshes, {.max_reference_ratio = 2.0f, .max_leaf_size = 3, .radius = 2})});
  return result;
}

void expect_equal_answers(std::span<const TriangleMesh> meshes, std::span<const Ray> rays,
                          std::span<const Vec3f> points) {
  const Tree tree = build_tree(meshes);
  const kerf::Bvh bvh = make_bvh(tree);
  for (const auto& [name, hierarchy] : hierarchies(meshes, tree, bvh)) {
    SCOPED_TRACE(name);
    std::size_t different[6] = {};
    for (const Ray& ray : rays) {
      const Hit closest = bvh.intersect(ray).value_or(Hit{});
      different[0] += !(hierarchy.intersect(ray) == closest);
      different[1] += hierarchy.occluded(ray) != static_cast<bool>(closest);
      std::vector<Hit> all;
      bvh.all_hits(ray, [&](const Hit& hit) { all.push_back(hit); });
      different[2] += hierarchy.all_hits(ray) != all;
    }
    for (const Vec3f& point : points) {
      different[3] += hierarchy.contains(point) != bvh.contains(point);
      different[4] += !(hierarchy.signed_distance(point) == bvh.signed_distance(point));
      for (const float limit : {0.0f, 1.5f, std::numeric_limits<float>::infinity()})
        different[5] += !(hierarchy.closest_point(point, limit) ==
                          bvh.closest_point(point, limit).value_or(SurfacePoint{}));
    }
    EXPECT_EQ(different[0], 0u) << "closest hits";
    EXPECT_EQ(different[1], 0u) << "any hit";
    EXPECT_EQ(different[2], 0u) << "all hits";
    EXPECT_EQ(different[3], 0u) << "contains";
    EXPECT_EQ(different[4], 0u) << "signed distance";
    EXPECT_EQ(different[5], 0u) << "closest point";
  }
}

TEST(CudaTraversal, AnswersOfOddRaysAndPointsAreTheLibrarys) {
  for (const float scale : {1.0f, 1e-9f, 3e12f, 0x1p80f, 0x1p-100f, 0x1p100f, 0x1p121f}) {
    SCOPED_TRACE(scale);
    GridMeshes grid(scale);
    std::vector<Ray> rays(3000);
    for (Ray& ray : rays) ray = grid.ray();
    std::vector<Vec3f> points(500);
    for (Vec3f& point : points) {
      point = grid.point();
      if (grid.below(10) == 0) point.x *= 1e6f;
      if (grid.below(100) == 0) point.y = std::numeric_limits<float>::quiet_NaN();
    }
    expect_equal_answers(grid.meshes, rays, points);
  }
}

TEST(CudaTraversal, AnswersOfAClosedSurfaceAreTheLibrarys) {
  const ClosedSurface surface;
  const TriangleMesh mesh = surface.mesh();
  std::mt19937 random(3);
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * (static_cast<float>(random() >> 8) * 0x1p-24f);
  };
  std::vector<Ray> rays(3000);
  std::vector<Vec3f> points(1000);
  for (Ray& ray : rays) {
    ray.origin = {uniform(-1.5f, 1.5f), uniform(-1.5f, 1.5f), uniform(-1.5f, 1.5f)};
    const Vec3f at = surface.vertices[random() % surface.vertices.size()];
    ray.direction = {at.x - ray.origin.x, at.y - ray.origin.y, at.z - ray.origin.z};
  }
  for (Vec3f& point : points)
    point = random() % 3 == 0 ? surface.vertices[random() % surface.vertices.size()]
                              : Vec3f{uniform(-1.5f, 1.5f), uniform(-1.5f, 1.5f), uniform(-1.5f, 1.5f)};
  expect_equal_answers({&mesh, 1}, rays, points);
}

TEST(CudaTraversal, SmallHierarchiesAnswerAsTheLibraryDoes) {
  GridMeshes grid(1.0f);
  std::vector<Ray> rays(300);
  for (Ray& ray : rays) ray = grid.ray();
  std::vector<Vec3f> points(50);
  for (Vec3f& point : points) point = grid.point();
  for (const std::size_t count : {0u, 1u, 2u, 3u, 9u, 30u}) {
    SCOPED_TRACE(count);
    const TriangleMesh mesh{.vertices = grid.vertices, .triangles = std::span(grid.triangles).first(count)};
    expect_equal_answers({&mesh, 1}, rays, points);
  }
}

TEST(CudaTraversal, ListsAsManyHitsAsThereIsRoomFor) {
  GridMeshes grid(1.0f);
  const kerf::Bvh bvh = kerf::build(grid.meshes);
  const HostHierarchy hierarchy = built(grid.meshes, {});
  for (int i = 0; i < 500; ++i) {
    const Ray ray = grid.ray();
    std::vector<Hit> all;
    bvh.all_hits(ray, [&](const Hit& hit) { all.push_back(hit); });
    for (const std::size_t room : {0u, 1u, 8u, 200u}) {
      std::vector<Hit> listed(room, Hit{.t = 1.0f, .primitive = 1, .mesh = 1});
      list_crossings(hierarchy.view(), hierarchy.table(), ray, listed.data(), room);
      std::vector<Hit> expected(all.begin(),
                                all.begin() + static_cast<std::ptrdiff_t>(std::min(room, all.size())));
      expected.resize(room);
      ASSERT_EQ(listed, expected);
    }
  }
}

}  // namespace
}  // namespace kerf::cuda
