#include "workbench/generate/solids.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "workbench/base/vectors.hpp"
#include "workbench/sampling/angles.hpp"

namespace workbench {

using namespace kerf;

namespace {

Solid make_icosahedron() {
  // The corners of three golden rectangles, one in each plane of axes. The caller moves them onto a sphere.
  constexpr float g = 1.6180339887f;
  return {.vertices = {{-1, g, 0},
                       {1, g, 0},
                       {-1, -g, 0},
                       {1, -g, 0},
                       {0, -1, g},
                       {0, 1, g},
                       {0, -1, -g},
                       {0, 1, -g},
                       {g, 0, -1},
                       {g, 0, 1},
                       {-g, 0, -1},
                       {-g, 0, 1}},
          .triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
}

// Each triangle becomes four; a new vertex stands on the unit sphere above the middle of each edge.
void subdivide(Solid& solid) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle_of = [&](std::uint32_t a, std::uint32_t b) {
    const auto [entry, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(solid.vertices.size()));
    if (is_new) solid.vertices.push_back(normalize(solid.vertices[a] + solid.vertices[b]));
    return entry->second;
  };
  std::vector<std::array<std::uint32_t, 3>> finer;
  finer.reserve(4 * solid.triangles.size());
  for (const auto& [a, b, c] : solid.triangles) {
    const std::uint32_t ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  solid.triangles = std::move(finer);
}

}  // namespace

Solid make_sphere(int level, float radius, Vec3f center) {
  Solid solid = make_icosahedron();
  for (Vec3f& vertex : solid.vertices) vertex = normalize(vertex);
  for (int i = 0; i < level; ++i) subdivide(solid);
  for (Vec3f& vertex : solid.vertices) vertex = center + radius * vertex;
  return solid;
}

Solid make_torus(std::uint32_t major, std::uint32_t minor, float ring_radius, float tube_radius) {
  Solid solid;
  for (std::uint32_t i = 0; i < major; ++i) {
    const auto [ring_sine, ring_cosine] = sine_cosine(static_cast<double>(i) / major);
    for (std::uint32_t j = 0; j < minor; ++j) {
      const auto [tube_sine, tube_cosine] = sine_cosine(static_cast<double>(j) / minor);
      const float r = ring_radius + tube_radius * tube_cosine;
      solid.vertices.push_back({r * ring_cosine, tube_radius * tube_sine, r * ring_sine});
      const std::uint32_t i1 = (i + 1) % major, j1 = (j + 1) % minor;
      const std::uint32_t a = i * minor + j, b = i1 * minor + j, c = i1 * minor + j1, d = i * minor + j1;
      solid.triangles.insert(solid.triangles.end(), {{a, c, b}, {a, d, c}});
    }
  }
  return solid;
}

Solid make_box(Vec3f lower, Vec3f upper, std::uint32_t divisions) {
  Solid solid;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t>
      indices;  // of the vertices, by their place in the grid
  const auto vertex_at = [&](const std::array<std::uint32_t, 3>& place) {
    const auto [entry, is_new] =
        indices.try_emplace(place, static_cast<std::uint32_t>(solid.vertices.size()));
    if (is_new) {
      Vec3f vertex;
      for (int axis = 0; axis < 3; ++axis) {
        const float s =
            static_cast<float>(place[static_cast<std::size_t>(axis)]) / static_cast<float>(divisions);
        vertex[axis] = (1.0f - s) * lower[axis] + s * upper[axis];
      }
      solid.vertices.push_back(vertex);
    }
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const std::uint32_t side : {0u, divisions}) {
      for (std::uint32_t i = 0; i < divisions; ++i) {
        for (std::uint32_t j = 0; j < divisions; ++j) {
          const auto corner = [&](std::uint32_t du, std::uint32_t dv) {
            std::array<std::uint32_t, 3> place{};
            place[axis] = side;
            place[u] = i + du;
            place[v] = j + dv;
            return vertex_at(place);
          };
          std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == 0) std::swap(b, d);  // the lower face is turned the other way
          solid.triangles.insert(solid.triangles.end(), {{a, b, c}, {a, c, d}});
        }
      }
    }
  }
  return solid;
}

}  // namespace workbench
