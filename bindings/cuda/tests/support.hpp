// Hierarchies in the device's layout, traced on the host by the code that kernels run.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "../src/binary_traversal.hpp"
#include "../src/build/build.hpp"
#include "../src/closest_point.hpp"
#include "../src/encode.hpp"
#include "../src/host_executor.hpp"
#include "../src/list_hits.hpp"
#include "../src/source_tree.hpp"

namespace kerf::cuda {

struct HostHierarchy {
  std::vector<PairNode> nodes;
  std::vector<DeviceTriangle> triangles;
  std::vector<std::uint32_t> numbers, first_triangles;
  SceneBounds bounds{};

  BinaryHierarchy view() const {
    return {nodes.data(), triangles.data(), &bounds, static_cast<std::uint32_t>(nodes.size())};
  }
  MeshTable table() const {
    if (first_triangles.empty()) return {nullptr, 0};
    return {first_triangles.data(), static_cast<std::uint32_t>(first_triangles.size() - 1)};
  }

  Hit intersect(const Ray& ray) const { return trace_closest(view(), table(), &ray); }
  bool occluded(const Ray& ray) const { return trace_any(view(), &ray); }
  std::vector<Hit> all_hits(const Ray& ray) const {
    std::vector<Hit> hits(count_crossings(view(), ray));
    list_crossings(view(), table(), ray, hits.data(), hits.size());
    return hits;
  }
  bool contains(const Vec3f& point) const { return cuda::contains(view(), point); }
  SurfacePoint closest_point(const Vec3f& point, float max_distance) const {
    return cuda::closest_point(view(), table(), point, max_distance);
  }
  float signed_distance(const Vec3f& point) const { return cuda::signed_distance(view(), table(), point); }
};

/// As an upload makes it.
inline HostHierarchy uploaded(const SourceTree& tree, std::vector<std::uint32_t> first_triangles) {
  const EncodedBinary encoded = encode_binary(tree);
  HostHierarchy result{encoded.nodes, encoded.triangles, {}, std::move(first_triangles), encoded.bounds};
  for (const SourceTriangle& reference : tree.references) result.numbers.push_back(reference.number);
  return result;
}

/// Meshes as kernels read them.
inline std::vector<InputMesh> input_of(std::span<const TriangleMesh> meshes,
                                       std::vector<std::uint32_t>& firsts) {
  std::vector<InputMesh> result;
  std::uint32_t count = 0;
  for (const TriangleMesh& mesh : meshes) {
    firsts.push_back(count);
    result.push_back({mesh.vertices.data(), mesh.vertices.stride(),
                      static_cast<std::uint32_t>(mesh.vertices.size()), mesh.triangles.data(),
                      mesh.triangles.stride(), static_cast<std::uint32_t>(mesh.triangles.size()), count});
    count += static_cast<std::uint32_t>(mesh.triangles.size());
  }
  firsts.push_back(count);
  return result;
}

/// As the build on the device makes it.
inline HostHierarchy built(std::span<const TriangleMesh> meshes, const PlocOptions& options,
                           BuiltHierarchy<HostExecutor>* figures = nullptr) {
  HostHierarchy result;
  const std::vector<InputMesh> input = input_of(meshes, result.first_triangles);
  HostExecutor executor;
  BuiltHierarchy<HostExecutor> out =
      build_hierarchy(executor, std::span(input), result.first_triangles.back(), options);
  for (int axis = 0; axis < 3; ++axis) {
    result.bounds.lower[axis] = out.bounds.lower[axis];
    result.bounds.upper[axis] = out.bounds.upper[axis];
  }
  result.nodes = out.nodes;
  result.triangles = out.triangles;
  result.numbers = out.numbers;
  if (figures) *figures = std::move(out);
  return result;
}

/// Triangles whose corners stand on a coarse grid, many of them without area or on top of each other, in
/// three meshes.
struct GridMeshes {
  std::vector<Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::array<TriangleMesh, 3> meshes;
  std::mt19937 random;
  float scale;

  explicit GridMeshes(float scale_, std::uint32_t count = 400, unsigned seed = 7)
      : random(seed), scale(scale_) {
    for (std::uint32_t i = 0; i < count; ++i) {
      for (int corner = 0; corner < 3; ++corner)
        vertices.push_back(scaled({on_grid(), on_grid(), on_grid()}));
      triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const std::span all(triangles);
    meshes = {TriangleMesh{.vertices = vertices, .triangles = all.subspan(0, count / 4)},
              TriangleMesh{.vertices = vertices, .triangles = all.subspan(count / 4, 1)},
              TriangleMesh{.vertices = vertices, .triangles = all.subspan(count / 4 + 1)}};
  }
  GridMeshes(const GridMeshes&) = delete;

  unsigned below(unsigned n) { return static_cast<unsigned>(random() % n); }
  float on_grid() { return static_cast<float>(static_cast<int>(below(9)) - 4); }
  Vec3f scaled(Vec3f p) const { return {p.x * scale, p.y * scale, p.z * scale}; }

  /// On the grid, or near it.
  Vec3f point() {
    Vec3f p{on_grid(), on_grid(), on_grid()};
    if (below(3) == 0)
      for (int axis = 0; axis < 3; ++axis) p[axis] += static_cast<float>(below(1000)) * 1e-3f;
    return scaled(p);
  }

  /// Rays as nobody wants them: through vertices, along edges, in planes of faces, with directions of zero
  /// components, very long and very short, with odd limits.
  Ray ray() {
    Ray ray{.origin = point(), .direction = {}};
    const Vec3f at = point();
    for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = at[axis] - ray.origin[axis];
    const float factors[] = {1.0f, 1.0f, 1.0f, 1e-12f, 1e12f, 1e-30f, 1e25f, -1.0f};
    const float factor = factors[below(8)];
    for (int axis = 0; axis < 3; ++axis) ray.direction[axis] *= factor;
    const float specials[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                              0.0f, -0.0f};
    if (below(8) == 0) ray.direction[static_cast<int>(below(3))] = specials[2 + below(2)];
    if (below(100) == 0) ray.direction[static_cast<int>(below(3))] = specials[below(4)];
    if (below(100) == 0) ray.origin[static_cast<int>(below(3))] = specials[below(2)];
    if (below(4) == 0) ray.t_max = static_cast<float>(below(1000)) * 2e-3f;
    if (below(4) == 0) ray.t_min = static_cast<float>(below(1000)) * 1e-3f - 0.1f;
    if (below(100) == 0) ray.t_max = specials[below(4)];
    if (below(100) == 0) ray.t_min = specials[below(4)];
    const float subnormal[] = {0x1p-149f, 0x1p-148f, 0x3p-149f, 0x1p-126f};
    if (below(50) == 0) ray.t_max = subnormal[below(4)];
    if (below(50) == 0) ray.t_min = subnormal[below(4)] * (below(2) == 0 ? 1.0f : -1.0f);
    return ray;
  }
};

/// A closed surface: a sphere of triangles with bumps, or a tetrahedron for `detail` 0.
struct ClosedSurface {
  std::vector<Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  explicit ClosedSurface(std::uint32_t rings = 24, Vec3f center = {}) {
    const std::uint32_t around = 2 * rings;
    vertices.push_back({center.x, center.y, center.z + 1.0f});
    for (std::uint32_t r = 1; r < rings; ++r)
      for (std::uint32_t a = 0; a < around; ++a) {
        const double theta = 3.14159265358979 * r / rings, phi = 2 * 3.14159265358979 * a / around;
        const double radius = 1.0 + 0.2 * std::sin(5 * phi) * std::sin(3 * theta);
        vertices.push_back({center.x + static_cast<float>(radius * std::sin(theta) * std::cos(phi)),
                            center.y + static_cast<float>(radius * std::sin(theta) * std::sin(phi)),
                            center.z + static_cast<float>(radius * std::cos(theta))});
      }
    vertices.push_back({center.x, center.y, center.z - 1.0f});
    const auto at = [&](std::uint32_t r, std::uint32_t a) { return 1 + (r - 1) * around + a % around; };
    const auto last = static_cast<std::uint32_t>(vertices.size() - 1);
    for (std::uint32_t a = 0; a < around; ++a) {
      triangles.push_back({0, at(1, a), at(1, a + 1)});
      for (std::uint32_t r = 1; r + 1 < rings; ++r) {
        triangles.push_back({at(r, a), at(r + 1, a), at(r + 1, a + 1)});
        triangles.push_back({at(r, a), at(r + 1, a + 1), at(r, a + 1)});
      }
      triangles.push_back({at(rings - 1, a), last, at(rings - 1, a + 1)});
    }
  }
  TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

}  // namespace kerf::cuda
