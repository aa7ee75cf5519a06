// A device's answers: bit for bit what the library answers on the CPU. Skipped where there is no device.
#include <cuda_runtime_api.h>
#include <gtest/gtest.h>
#include <kerf/cuda/bvh.hpp>
#include <kerf/cuda/gather.hpp>

#include "../src/device_array.hpp"
#include "support.hpp"

namespace kerf::cuda {
namespace {

class CudaDevice : public testing::Test {
 protected:
  void SetUp() override {
    int count = 0;
    const cudaError_t result = cudaGetDeviceCount(&count);
    if (result != cudaSuccess || count == 0)
      GTEST_SKIP() << "NO CUDA DEVICE, nothing is tested here: " << cudaGetErrorString(result);
  }
};

template <class T>
std::vector<T> fetched(const DeviceArray<T>& array) {
  std::vector<T> values(array.size());
  if (!values.empty()) array.copy_to(values);
  return values;
}
template <class T>
DeviceArray<T> sent(const std::vector<T>& values) {
  return DeviceArray<T>(std::span<const T>(values));
}

// Meshes whose vertices and triangles lie on the device.
struct DeviceMeshes {
  std::vector<DeviceArray<Vec3f>> vertices;
  std::vector<DeviceArray<std::array<std::uint32_t, 3>>> triangles;
  std::vector<TriangleMesh> meshes;

  explicit DeviceMeshes(std::span<const TriangleMesh> from) {
    for (const TriangleMesh& mesh : from) {
      std::vector<Vec3f> v(mesh.vertices.size());
      for (std::size_t i = 0; i < v.size(); ++i) {
        const auto triple = mesh.vertices[i];
        v[i] = {triple.values[0], triple.values[1], triple.values[2]};
      }
      std::vector<std::array<std::uint32_t, 3>> t(mesh.triangles.size());
      for (std::size_t i = 0; i < t.size(); ++i) {
        const auto triple = mesh.triangles[i];
        t[i] = {triple.values[0], triple.values[1], triple.values[2]};
      }
      vertices.push_back(sent(v));
      triangles.push_back(sent(t));
      meshes.push_back(
          {.vertices = {vertices.back().data(), v.size()}, .triangles = {triangles.back().data(), t.size()}});
    }
  }
};

std::size_t differing(const auto& a, const auto& b) {
  std::size_t count = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) count += !(a[i] == b[i]);
  return count;
}

void expect_equal_answers(const Bvh& device, const kerf::Bvh& host, const std::vector<Ray>& rays,
                          const std::vector<Vec3f>& points) {
  const std::size_t n = rays.size(), m = points.size();
  std::vector<Hit> closest(n);
  std::vector<std::uint8_t> occluded(n), inside(m);
  host.intersect(rays, closest);
  host.occluded(rays, occluded);
  std::vector<Hit> all;
  std::vector<std::uint32_t> counts(n);
  std::vector<std::uint64_t> offsets(1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    host.all_hits(rays[i], [&](const Hit& hit) { all.push_back(hit); });
    offsets.push_back(all.size());
    counts[i] = static_cast<std::uint32_t>(offsets[i + 1] - offsets[i]);
  }
  const DeviceArray<Ray> device_rays = sent(rays);
  const DeviceArray<Hit> hits = sent(std::vector<Hit>(n, Hit{.t = 5.0f, .primitive = 5, .mesh = 5}));
  const DeviceArray<std::uint8_t> any = sent(std::vector<std::uint8_t>(n, 5));
  device.intersect(device_rays.data(), hits.data(), n);
  device.occluded(device_rays.data(), any.data(), n);
  EXPECT_EQ(differing(fetched(hits), closest), 0u) << "closest hits";
  EXPECT_EQ(differing(fetched(any), occluded), 0u) << "any hit";
  const DeviceArray<std::uint32_t> device_counts = sent(std::vector<std::uint32_t>(n, 12345));
  device.count_hits(device_rays.data(), device_counts.data(), n);
  EXPECT_EQ(differing(fetched(device_counts), counts), 0u) << "number of hits";
  const DeviceArray<std::uint64_t> device_offsets = sent(offsets);
  const DeviceArray<Hit> listed =
      sent(std::vector<Hit>(all.size(), Hit{.t = 5.0f, .primitive = 5, .mesh = 5}));
  device.list_hits(device_rays.data(), device_offsets.data(), listed.data(), n);
  EXPECT_EQ(differing(fetched(listed), all), 0u) << "all hits";

  std::vector<float> distances(m);
  std::vector<SurfacePoint> surface(m), near(m);
  for (std::size_t i = 0; i < m; ++i) {
    inside[i] = host.contains(points[i]);
    distances[i] = host.signed_distance(points[i]);
    surface[i] = host.closest_point(points[i]).value_or(SurfacePoint{});
    near[i] = host.closest_point(points[i], 0.3f).value_or(SurfacePoint{});
  }
  const DeviceArray<Vec3f> device_points = sent(points);
  const DeviceArray<std::uint8_t> device_inside = sent(std::vector<std::uint8_t>(m, 5));
  const DeviceArray<float> device_distances = sent(std::vector<float>(m, 5.0f));
  const DeviceArray<SurfacePoint> device_surface =
      sent(std::vector<SurfacePoint>(m, SurfacePoint{.position = {}, .u = 5.0f}));
  device.contains(device_points.data(), device_inside.data(), m);
  device.signed_distance(device_points.data(), device_distances.data(), m);
  EXPECT_EQ(differing(fetched(device_inside), inside), 0u) << "contains";
  EXPECT_EQ(differing(fetched(device_distances), distances), 0u) << "signed distance";
  device.closest_point(device_points.data(), device_surface.data(), m);
  EXPECT_EQ(differing(fetched(device_surface), surface), 0u) << "closest point";
  device.closest_point(device_points.data(), device_surface.data(), m, 0.3f);
  EXPECT_EQ(differing(fetched(device_surface), near), 0u) << "closest point within a distance";
}

// From a tree, from a layout, and built there with and without splits.
void expect_equal_answers(std::span<const TriangleMesh> meshes, const std::vector<Ray>& rays,
                          const std::vector<Vec3f>& points) {
  const Tree tree = build_tree(meshes);
  const kerf::Bvh host = make_bvh(tree);
  const DeviceMeshes on_device(meshes);
  const auto compare = [&](const char* name, const Bvh& device) {
    SCOPED_TRACE(name);
    EXPECT_EQ(device.bounds(), host.bounds());
    expect_equal_answers(device, host, rays, points);
  };
  compare("tree", Bvh(tree));
  compare("layout", Bvh(host));
  compare("built", Bvh::build(on_device.meshes));
  compare("built without splits", Bvh::build(on_device.meshes, {.max_reference_ratio = 1.0f}));
  compare("built with more splits",
          Bvh::build(on_device.meshes, {.max_reference_ratio = 3.0f, .max_leaf_size = 2, .radius = 3}));
}

TEST_F(CudaDevice, OddRaysAndPoints) {
  for (const float scale : {1.0f, 1e-9f, 3e12f, 0x1p80f}) {
    SCOPED_TRACE(scale);
    GridMeshes grid(scale);
    std::vector<Ray> rays(20000);
    for (Ray& ray : rays) ray = grid.ray();
    std::vector<Vec3f> points(5000);
    for (Vec3f& point : points) {
      point = grid.point();
      if (grid.below(10) == 0) point.x *= 1e6f;
      if (grid.below(100) == 0) point.y = std::numeric_limits<float>::quiet_NaN();
    }
    expect_equal_answers(grid.meshes, rays, points);
  }
}

std::vector<Ray> rays_at(const ClosedSurface& surface, std::size_t count, std::mt19937& random) {
  std::vector<Ray> rays(count);
  const auto uniform = [&] { return 3.0f * static_cast<float>(random() >> 8) * 0x1p-24f - 1.5f; };
  for (Ray& ray : rays) {
    ray.origin = {uniform(), uniform(), uniform()};
    const Vec3f at = surface.vertices[random() % surface.vertices.size()];
    ray.direction = {at.x - ray.origin.x, at.y - ray.origin.y, at.z - ray.origin.z};
  }
  return rays;
}
std::vector<Vec3f> points_at(const ClosedSurface& surface, std::size_t count, std::mt19937& random) {
  std::vector<Vec3f> points(count);
  const auto uniform = [&] { return 3.0f * static_cast<float>(random() >> 8) * 0x1p-24f - 1.5f; };
  for (Vec3f& point : points)
    point = random() % 3 == 0 ? surface.vertices[random() % surface.vertices.size()]
                              : Vec3f{uniform(), uniform(), uniform()};
  return points;
}

TEST_F(CudaDevice, ClosedSurface) {
  const ClosedSurface surface(60);
  std::mt19937 random(3);
  const TriangleMesh mesh = surface.mesh();
  expect_equal_answers({&mesh, 1}, rays_at(surface, 30000, random), points_at(surface, 10000, random));
}

TEST_F(CudaDevice, SmallHierarchies) {
  GridMeshes grid(1.0f);
  std::vector<Ray> rays(300);
  for (Ray& ray : rays) ray = grid.ray();
  std::vector<Vec3f> points(50);
  for (Vec3f& point : points) point = grid.point();
  for (const std::size_t count : {0, 1, 2, 3, 9, 30}) {
    SCOPED_TRACE(count);
    const TriangleMesh mesh{.vertices = grid.vertices, .triangles = std::span(grid.triangles).first(count)};
    expect_equal_answers({&mesh, 1}, rays, points);
  }
  expect_equal_answers(Bvh(), kerf::Bvh(), rays, points);
}

TEST_F(CudaDevice, Refits) {
  ClosedSurface surface(40);
  const TriangleMesh mesh = surface.mesh();
  const DeviceMeshes first({&mesh, 1});
  std::vector<Bvh> hierarchies{Bvh(build_tree(mesh)), Bvh(kerf::build(mesh)), Bvh::build(first.meshes),
                               Bvh::build(first.meshes, {.max_reference_ratio = 1.0f})};
  std::mt19937 random(9);
  for (int frame = 0; frame < 3; ++frame) {
    for (Vec3f& v : surface.vertices) {
      v.x += 0.3f * v.z * v.z;
      v.y *= 1.1f;
    }
    const Vec3f kept = surface.vertices[30];
    if (frame == 1) surface.vertices[30] = surface.vertices[31];
    const TriangleMesh moved = surface.mesh();
    const DeviceMeshes now({&moved, 1});
    const kerf::Bvh host = kerf::build(moved);
    const std::vector<Ray> rays = rays_at(surface, 5000, random);
    const std::vector<Vec3f> points = points_at(surface, 2000, random);
    for (std::size_t i = 0; i < hierarchies.size(); ++i) {
      SCOPED_TRACE(i);
      hierarchies[i].refit(now.meshes);
      EXPECT_EQ(hierarchies[i].bounds(), host.bounds());
      expect_equal_answers(hierarchies[i], host, rays, points);
    }
    surface.vertices[30] = kept;
  }
}

TEST_F(CudaDevice, StreamsAndGraphs) {
  ClosedSurface surface(40);
  const TriangleMesh mesh = surface.mesh();
  const DeviceMeshes meshes({&mesh, 1});
  Bvh device = Bvh::build(meshes.meshes);
  std::mt19937 random(4);
  const std::vector<Ray> rays = rays_at(surface, 20000, random);
  const std::vector<Vec3f> points = points_at(surface, 20000, random);
  const DeviceArray<Ray> device_rays = sent(rays);
  const DeviceArray<Vec3f> device_points = sent(points);
  const DeviceArray<Hit> hits(rays.size());
  const DeviceArray<std::uint32_t> counts(rays.size());
  const DeviceArray<std::uint8_t> inside(points.size());
  const DeviceArray<float> distances(points.size());
  cudaStream_t stream;
  ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  ASSERT_EQ(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), cudaSuccess);
  ASSERT_EQ(cudaStreamBeginCapture(stream, cudaStreamCaptureModeGlobal), cudaSuccess);
  device.refit(meshes.meshes, stream);
  device.intersect(device_rays.data(), hits.data(), rays.size(), stream);
  device.count_hits(device_rays.data(), counts.data(), rays.size(), stream);
  device.contains(device_points.data(), inside.data(), points.size(), stream);
  device.signed_distance(device_points.data(), distances.data(), points.size(), stream);
  cudaGraph_t graph;
  ASSERT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
  cudaGraphExec_t replay;
  ASSERT_EQ(cudaGraphInstantiate(&replay, graph, 0), cudaSuccess);
  for (int frame = 0; frame < 3; ++frame) {
    // The graph reads the vertices anew.
    for (Vec3f& v : surface.vertices) v.x += 0.1f * v.y;
    ASSERT_EQ(cudaMemcpy(meshes.vertices[0].data(), surface.vertices.data(),
                         surface.vertices.size() * sizeof(Vec3f), cudaMemcpyHostToDevice),
              cudaSuccess);
    ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess);  // the graph's stream waits for no other
    ASSERT_EQ(cudaGraphLaunch(replay, stream), cudaSuccess);
    ASSERT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
    const kerf::Bvh host = kerf::build(surface.mesh());
    std::vector<Hit> expected(rays.size());
    host.intersect(rays, expected);
    EXPECT_EQ(differing(fetched(hits), expected), 0u);
    const std::vector<std::uint32_t> counted = fetched(counts);
    const std::vector<std::uint8_t> found_inside = fetched(inside);
    const std::vector<float> found_distances = fetched(distances);
    std::size_t different = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) different += counted[i] != host.all_hits(rays[i], {});
    for (std::size_t i = 0; i < points.size(); ++i)
      different += found_inside[i] != host.contains(points[i]) ||
                   found_distances[i] != host.signed_distance(points[i]);
    EXPECT_EQ(different, 0u);
  }
  cudaGraphExecDestroy(replay);
  cudaGraphDestroy(graph);
  cudaStreamDestroy(stream);
}

TEST_F(CudaDevice, SaysWhatIsWrong) {
  std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 3}};
  const auto message = [&](const BuildOptions& options = {}) {
    const TriangleMesh mesh{.vertices = vertices, .triangles = triangles};
    const DeviceMeshes meshes({&mesh, 1});
    try {
      Bvh::build(meshes.meshes, options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(), "CUDA: while building: a triangle names a vertex that its mesh has not");
  triangles[0][2] = 2;
  EXPECT_EQ(message(), "");
  EXPECT_EQ(message({.max_reference_ratio = 0.5f}),
            "CUDA: while building: max_reference_ratio must be in [1, 16]");
  EXPECT_EQ(message({.max_leaf_size = 9}), "CUDA: while building: max_leaf_size must be in [1, 8]");
  EXPECT_EQ(message({.radius = 0}), "CUDA: while building: radius must be in [1, 64]");
  vertices[2].z = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(message(), "CUDA: while building: a vertex is not finite, or not below 2^126");
  vertices[2].z = 0.0f;
  const TriangleMesh one{.vertices = vertices, .triangles = triangles};
  const DeviceMeshes meshes({&one, 1});
  Bvh device = Bvh::build(meshes.meshes);
  std::vector<TriangleMesh> two(2, meshes.meshes[0]);
  EXPECT_THROW(device.refit(two), Error);
}

TEST_F(CudaDevice, BuildsAreTheSameEachTimeAndKeepToTheirMemory) {
  GridMeshes grid(1.0f, 20000);
  const DeviceMeshes meshes(grid.meshes);
  const Bvh first = Bvh::build(meshes.meshes), second = Bvh::build(meshes.meshes);
  EXPECT_EQ(first.statistics().references, second.statistics().references);
  EXPECT_EQ(first.statistics().cost, second.statistics().cost);
  EXPECT_LE(first.statistics().references, 30000u);
  EXPECT_LE(first.statistics().bytes + first.statistics().scratch_bytes, build_bytes(20000));
}

TEST_F(CudaDevice, RaysAreGatheredAndCountsAreSummed) {
  const std::vector<float> origins{1, 2, 3, 9, 4, 5, 6, 9, 7, 8, 9, 9};  // with a gap behind each
  const std::vector<float> ends{10, 20, 30};
  const DeviceArray<float> device_origins = sent(origins), device_ends = sent(ends);
  RayView columns = RayView::origins_and_directions(device_origins.data(), nullptr, 3, 4 * sizeof(float));
  for (Column<const float>& column : columns.direction) column.data = nullptr;
  columns.t_max.data = device_ends.data();
  const DeviceArray<Ray> rays = sent(std::vector<Ray>(3));
  gather_rays(columns, {.origin = {}, .direction = {0, 0, -1}, .t_min = 0.5f}, rays.data());
  const std::vector<Ray> gathered = fetched(rays);
  for (std::size_t i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(gathered[i].origin[axis], origins[4 * i + static_cast<std::size_t>(axis)]);
    EXPECT_EQ(gathered[i].direction, (Vec3f{0, 0, -1}));
    EXPECT_EQ(gathered[i].t_min, 0.5f);
    EXPECT_EQ(gathered[i].t_max, ends[i]);
  }

  for (const std::size_t count : {0u, 1u, 1000u, 100000u}) {
    std::vector<std::uint32_t> counts(count);
    std::vector<std::uint64_t> sums(1, 0);
    for (std::size_t i = 0; i < count; ++i) {
      counts[i] = static_cast<std::uint32_t>(i * 2654435761u);  // whose sum takes more than 32 bits
      sums.push_back(sums.back() + counts[i]);
    }
    const DeviceArray<std::uint32_t> device_counts = sent(counts);
    const DeviceArray<std::uint64_t> offsets = sent(std::vector<std::uint64_t>(count + 1, 5));
    sum_counts(device_counts.data(), offsets.data(), count);
    EXPECT_EQ(differing(fetched(offsets), sums), 0u) << count << " counts";
  }
}

}  // namespace
}  // namespace kerf::cuda
