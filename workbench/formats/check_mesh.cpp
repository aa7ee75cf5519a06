#include "workbench/formats/check_mesh.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "workbench/base/parallel.hpp"
#include "workbench/base/raise.hpp"
#include "workbench/base/vectors.hpp"
#include "workbench/formats/turn.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;

/// Vertices and triangles that a thread looks at before it takes others: triangles are looked at twice.
constexpr std::size_t block = std::size_t{1} << 12;

[[noreturn]] void raise_index(const std::filesystem::path& file, const ReadMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t vertex : mesh.triangles[i]) {
      if (vertex < mesh.vertices.size()) continue;
      raise(Error::index_out_of_range, file, "triangle {} names vertex {}, but there are {}", i, vertex,
            mesh.vertices.size());
    }
  }
  raise(Error::index_out_of_range, file, "a triangle names a vertex that is not there");
}

void check_finite(const std::filesystem::path& file, const ReadMesh& mesh) {
  std::atomic<bool> all_finite = true;
  parallel_for_blocks(mesh.vertices.size(), block, [&](std::size_t begin, std::size_t end) {
    constexpr std::uint32_t sign = 0x80000000u, infinite = 0x7f800000u;
    std::uint32_t largest = 0;  // without their signs, bits of floats are ordered as they are
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f& p = mesh.vertices[i];
      for (const float x : {p.x, p.y, p.z})
        largest = std::max(largest, std::bit_cast<std::uint32_t>(x) & ~sign);
    }
    if (largest >= infinite) all_finite = false;
  });
  if (all_finite) return;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t vertex : mesh.triangles[i]) {
      const Vec3f& p = mesh.vertices[vertex];
      if (is_finite(p)) continue;
      if (mesh.describe_vertex) {
        const std::string what = mesh.describe_vertex(vertex);
        // A file that spells no number at all is of the wrong format.
        raise(what.find("finite") != std::string::npos ? Error::non_finite_vertex : Error::bad_format, file,
              "{}", what);
      }
      raise(Error::non_finite_vertex, file, "vertex {} of triangle {} is not finite: ({}, {}, {})", vertex, i,
            p.x, p.y, p.z);
    }
  }
}

void drop_unused_vertices(ReadMesh& mesh, const std::vector<std::uint8_t>& is_used) {
  if (std::find(is_used.begin(), is_used.end(), 0) == is_used.end()) return;
  std::vector<std::uint32_t> kept_as(mesh.vertices.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i]) continue;
    mesh.vertices[kept] = mesh.vertices[i];
    kept_as[i] = kept++;
  }
  mesh.vertices.resize(kept);
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = kept_as[vertex];
  }
}

struct Point {
  float x, y;
};

/// Whether the triangle surely has an area, seen along z: nearly all have. Each difference, each product and
/// the difference of the two is off by 2^-24 of itself, or by less than the smallest number. What overflows
/// is not sure.
inline bool surely_has_area(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const float plus = (b.x - a.x) * (c.y - a.y), minus = (b.y - a.y) * (c.x - a.x);
  return std::abs(plus - minus) > 0x1p-20f * (std::abs(plus) + std::abs(minus)) + 0x1p-120f;
}

bool has_area(const std::array<Vec3f, 3>& corners) {
  const auto& [a, b, c] = corners;
  for (int x = 0; x < 3; ++x) {
    const int y = (x + 1) % 3;
    if (turn(Point{a[x], a[y]}, Point{b[x], b[y]}, Point{c[x], c[y]}) != 0) return true;
  }
  return false;
}

std::array<Vec3f, 3> corners_of(const std::vector<Vec3f>& points, const ReadMesh::Triangle& triangle) {
  return {points[triangle[0]], points[triangle[1]], points[triangle[2]]};
}

// What a look at all triangles finds.
struct Found {
  std::vector<std::uint8_t> is_used;     ///< a vertex each
  std::vector<ReadMesh::Triangle> flat;  ///< those without an area that may have had one; in any order
};

Found look_at_triangles(const std::filesystem::path& file, const ReadMesh& mesh) {
  Found found;
  found.is_used.resize(mesh.vertices.size());
  const bool are_rounded = !mesh.remainders.empty() || mesh.remainders_of;
  std::atomic<bool> is_wrong = false;
  std::mutex mutex;
  parallel_for_blocks(mesh.triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    const std::span<const Vec3f> vertices = mesh.vertices;
    const auto triangles = std::span(mesh.triangles).subspan(begin, end - begin);
    const std::span<const std::uint32_t> corners(triangles[0].data(), 3 * triangles.size());
    std::uint32_t largest = 0;
    for (const std::uint32_t corner : corners) largest = std::max(largest, corner);
    if (largest >= vertices.size()) {
      is_wrong = true;
      return;
    }
    std::uint8_t* const is_used = found.is_used.data();
    const auto mark = [&](std::uint32_t vertex) {
      std::atomic_ref(is_used[vertex]).store(1, std::memory_order_relaxed);
    };
    for (const auto& [a, b, c] : triangles) mark(a), mark(b), mark(c);
    if (!are_rounded) return;
    std::vector<ReadMesh::Triangle> flat;
    for (const ReadMesh::Triangle& triangle : triangles) {
      const auto& [a, b, c] = triangle;
      if (surely_has_area(vertices[a], vertices[b], vertices[c])) continue;
      // Where a corner stands twice there never was an area.
      if (a != b && b != c && c != a && !has_area(corners_of(mesh.vertices, triangle)))
        flat.push_back(triangle);
    }
    if (flat.empty()) return;
    const std::lock_guard lock(mutex);
    found.flat.insert(found.flat.end(), flat.begin(), flat.end());
  });
  if (is_wrong) raise_index(file, mesh);
  return found;
}

std::size_t count_flattened(const ReadMesh& mesh, const std::vector<ReadMesh::Triangle>& flat) {
  if (flat.empty()) return 0;
  std::vector<std::uint32_t> vertices;
  for (const ReadMesh::Triangle& triangle : flat)
    vertices.insert(vertices.end(), triangle.begin(), triangle.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<Vec3f> remainders;
  if (mesh.remainders_of) {
    remainders = mesh.remainders_of(vertices);
  } else {
    for (const std::uint32_t vertex : vertices) remainders.push_back(mesh.remainders[vertex]);
  }
  const auto remainder_of = [&](std::uint32_t vertex) {
    return remainders[static_cast<std::size_t>(std::lower_bound(vertices.begin(), vertices.end(), vertex) -
                                               vertices.begin())];
  };
  std::size_t count = 0;
  for (const ReadMesh::Triangle& triangle : flat) {
    const auto& [a, b, c] = triangle;
    count += is_flattened(corners_of(mesh.vertices, triangle),
                          {remainder_of(a), remainder_of(b), remainder_of(c)});
  }
  return count;
}

}  // namespace

bool is_flattened(const std::array<Vec3f, 3>& corners, const std::array<Vec3f, 3>& remainders) {
  if (has_area(corners)) return false;
  const auto& [a, b, c] = corners;
  double u[3], v[3], size = 0.0, length = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double rest = remainders[0][axis];
    u[axis] = (double{b[axis]} - a[axis]) + (remainders[1][axis] - rest);
    v[axis] = (double{c[axis]} - a[axis]) + (remainders[2][axis] - rest);
    size = std::max({size, std::abs(double{a[axis]}), std::abs(double{b[axis]}), std::abs(double{c[axis]})});
    length = std::max({length, std::abs(u[axis]), std::abs(v[axis])});
  }
  // The file's own numbers are exact to 2^-53 of themselves: so far may corners on a line be off it.
  const double rounding = 0x1p-50 * size * length;
  for (int x = 0; x < 3; ++x) {
    const int y = (x + 1) % 3;
    if (std::abs(u[x] * v[y] - u[y] * v[x]) > rounding) return true;
  }
  return false;
}

void check_mesh(const std::filesystem::path& file, ReadMesh& mesh) {
  if (mesh.triangles.empty()) raise(Error::bad_format, file, "has no triangles");
  const Found found = look_at_triangles(file, mesh);
  check_finite(file, mesh);
  mesh.contents.flattened_triangles += count_flattened(mesh, found.flat);
  mesh.remainders = {};  // nothing asks for them from here on
  mesh.remainders_of = nullptr;
  drop_unused_vertices(mesh, found.is_used);
}

}  // namespace workbench
