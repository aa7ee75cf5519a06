#include "workbench/scene/surface.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

namespace workbench {
namespace {

// For each vertex the first one at its position. Zeros of either sign are one position.
std::vector<std::uint32_t> first_at_position(const std::vector<kerf::Vec3f>& vertices) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto position = [&](std::uint32_t i) {
    return std::tuple(vertices[i].x, vertices[i].y, vertices[i].z);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return position(a) != position(b) ? position(a) < position(b) : a < b;
  });
  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool repeats = i > 0 && position(order[i]) == position(order[i - 1]);
    first[order[i]] = repeats ? first[order[i - 1]] : order[i];
  }
  return first;
}

struct Edge {
  std::uint32_t low, high;
  int direction;  // 1 from low to high, -1 back

  bool same_place(const Edge& other) const { return low == other.low && high == other.high; }
  bool operator<(const Edge& other) const { return std::tie(low, high) < std::tie(other.low, other.high); }
};

}  // namespace

SurfaceFacts surface_facts(const Scene& scene) {
  const std::vector<std::uint32_t> first = first_at_position(scene.vertices);
  std::vector<Edge> edges;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& [a, b, c] : scene.triangles) {
    std::array<std::uint32_t, 3> corners{first[a], first[b], first[c]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
    std::sort(corners.begin(), corners.end());
    triangles.push_back(corners);
  }
  SurfaceFacts facts;
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    int balance = 0;
    const Edge& edge = edges[i];
    for (; i < edges.size() && edges[i].same_place(edge); ++i) balance += edges[i].direction;
    facts.open_edges += balance != 0;
  }
  std::sort(triangles.begin(), triangles.end());
  for (std::size_t i = 1; i < triangles.size(); ++i)
    facts.doubled_triangles += triangles[i] == triangles[i - 1];
  return facts;
}

}  // namespace workbench
