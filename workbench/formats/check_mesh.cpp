#include "workbench/formats/check_mesh.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "workbench/base/parallel.hpp"
#include "workbench/base/raise.hpp"
#include "workbench/base/vectors.hpp"
#include "workbench/formats/turn.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;

/// Vertices and triangles that a thread looks at before it takes others.
constexpr std::size_t block = std::size_t{1} << 16;

void check_indices(const std::filesystem::path& file, const ReadMesh& mesh) {
  std::atomic<bool> is_wrong = false;
  parallel_for_blocks(mesh.triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t largest = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      largest = std::max({largest, a, b, c});
    }
    if (largest >= mesh.vertices.size()) is_wrong = true;
  });
  if (!is_wrong) return;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t vertex : mesh.triangles[i]) {
      if (vertex < mesh.vertices.size()) continue;
      raise(Error::index_out_of_range, file, "triangle {} names vertex {}, but there are {}", i, vertex,
            mesh.vertices.size());
    }
  }
}

void check_finite(const std::filesystem::path& file, const ReadMesh& mesh) {
  std::atomic<bool> all_finite = true;
  parallel_for_blocks(mesh.vertices.size(), block, [&](std::size_t begin, std::size_t end) {
    float zero = 0.0f;  // stays zero, unless something times zero is no number
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f& p = mesh.vertices[i];
      zero += p.x * 0.0f + p.y * 0.0f + p.z * 0.0f;
    }
    if (zero != 0.0f || std::isnan(zero)) all_finite = false;
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

void drop_unused_vertices(ReadMesh& mesh) {
  std::vector<std::uint8_t> is_used(mesh.vertices.size(), 0);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) is_used[vertex] = 1;
  }
  const auto first_unused = std::find(is_used.begin(), is_used.end(), 0);
  if (first_unused == is_used.end()) return;
  std::vector<std::uint32_t> kept_as(mesh.vertices.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i]) continue;
    mesh.vertices[kept] = mesh.vertices[i];
    if (!mesh.remainders.empty()) mesh.remainders[kept] = mesh.remainders[i];
    kept_as[i] = kept++;
  }
  mesh.vertices.resize(kept);
  if (!mesh.remainders.empty()) mesh.remainders.resize(kept);
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = kept_as[vertex];
  }
}

struct Point {
  float x, y;
};

// Nearly all have.
inline bool has_area(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return turn(Point{a.x, a.y}, Point{b.x, b.y}, Point{c.x, c.y}) != 0;
}

std::size_t count_flattened(const ReadMesh& mesh) {
  if (mesh.remainders.empty()) return 0;
  std::atomic<std::size_t> count = 0;
  parallel_for_blocks(mesh.triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    std::size_t of_block = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      if (has_area(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) continue;
      of_block += is_flattened({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                               {mesh.remainders[a], mesh.remainders[b], mesh.remainders[c]});
    }
    count += of_block;
  });
  return count;
}

}  // namespace

bool is_flattened(const std::array<Vec3f, 3>& corners, const std::array<Vec3f, 3>& remainders) {
  const auto& [a, b, c] = corners;
  for (int x = 0; x < 3; ++x) {
    const int y = (x + 1) % 3;
    if (turn(Point{a[x], a[y]}, Point{b[x], b[y]}, Point{c[x], c[y]}) != 0) return false;
  }
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
  check_indices(file, mesh);
  check_finite(file, mesh);
  drop_unused_vertices(mesh);
  mesh.contents.flattened_triangles += count_flattened(mesh);
}

}  // namespace workbench
