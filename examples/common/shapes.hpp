// What the examples look at: closed surfaces and a floor, as the arrays that kerf takes.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace shapes {

using Point = std::array<float, 3>;
using Triangle = std::array<unsigned, 3>;

struct Mesh {
  std::vector<Point> vertices;
  std::vector<Triangle> triangles;
};

/// A closed surface over a grid of `rows` times `columns`, both of which close: `point(i, j)` is a corner.
template <class PointAt>
Mesh closed_grid(unsigned rows, unsigned columns, const PointAt& point) {
  Mesh mesh;
  for (unsigned i = 0; i < rows; ++i) {
    for (unsigned j = 0; j < columns; ++j) {
      mesh.vertices.push_back(point(i, j));
      const unsigned a = i * columns + j, b = i * columns + (j + 1) % columns;
      const unsigned c = (i + 1) % rows * columns + (j + 1) % columns, d = (i + 1) % rows * columns + j;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

/// A ring about the z axis whose tube has waves, outside outwards.
inline Mesh make_ring(unsigned rows = 160, unsigned columns = 64) {
  return closed_grid(rows, columns, [=](unsigned i, unsigned j) {
    const float around = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rows);
    const float across =
        2.0f * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(columns);
    const float tube = 0.34f + 0.05f * std::sin(9.0f * around + 2.0f * across);
    const float radius = 1.0f + tube * std::cos(across);
    return Point{radius * std::cos(around), radius * std::sin(around), tube * std::sin(across)};
  });
}

/// A square of the plane z = `height`, of two triangles.
inline Mesh make_floor(float half, float height) {
  return {{{-half, -half, height}, {half, -half, height}, {half, half, height}, {-half, half, height}},
          {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace shapes
