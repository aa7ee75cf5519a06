// Triangles and rays made to be hard: on small grids, where everything is aligned with everything, and aimed
// at the vertices and edges of triangles from near and from far.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <kerf/kerf.hpp>

#include "math/predicates.hpp"
#include "math/triangle.hpp"
#include "math/vec3f.hpp"

namespace adversarial {

using kerf::Ray;
using kerf::Triangle;
using kerf::Vec3f;

/// Triangles that share no vertices in memory, as a mesh.
struct Soup {
  std::vector<Triangle> triangles;

  std::vector<std::uint32_t> indices;  ///< 0, 1, 2, ...

  explicit Soup(std::vector<Triangle> all) : triangles(std::move(all)), indices(3 * triangles.size()) {
    for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
  }
  kerf::TriangleMesh mesh() const {
    return {.vertices = {reinterpret_cast<const Vec3f*>(triangles.data()), 3 * triangles.size()},
            .triangles = indices};
  }
};

inline float uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random() >> 8) * 0x1p-24f);
}

inline float power_of_ten(std::mt19937& random, float low, float high) {
  return std::pow(10.0f, uniform(random, low, high));
}

inline Vec3f uniform_point(std::mt19937& random, float scale) {
  const float x = uniform(random, -scale, scale), y = uniform(random, -scale, scale),
              z = uniform(random, -scale, scale);
  return {x, y, z};
}

/// Integer coordinates from -`half` to `half`.
inline Vec3f grid_point(std::mt19937& random, int half) {
  const auto coordinate = [&] {
    return static_cast<float>(static_cast<int>(random() % (2 * static_cast<unsigned>(half) + 1)) - half);
  };
  const float x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}

template <class MakePoint>
Soup soup(std::size_t count, MakePoint&& point) {
  std::vector<Triangle> triangles;
  while (triangles.size() < count) {
    const Vec3f a = point(), b = point(), c = point();
    if (!kerf::collinear(a, b, c)) triangles.push_back({a, b, c});
  }
  return Soup(std::move(triangles));
}

/// A ray from beside the plane of the triangle, towards a point of the triangle or the other way.
inline Ray ray_from_beside(std::mt19937& random, const Triangle& triangle, float height) {
  const float s = uniform(random, 0.0f, 1.0f), r = uniform(random, 0.0f, 1.0f);
  const auto inside = [&](float p, float q) {
    return triangle.v0 + p * (1.0f - q) * (triangle.v1 - triangle.v0) + p * q * (triangle.v2 - triangle.v0);
  };
  const Vec3f n = cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0);
  const Vec3f from = inside(uniform(random, 0.0f, 1.0f), r) + (height / length(n)) * n;
  const Vec3f to = inside(s, uniform(random, 0.0f, 1.0f));
  return {.origin = from, .direction = random() % 4 != 0 ? to - from : from - to};
}

/// A ray that is hard for `target`: through a vertex, a point of an edge or of the inside, along an edge, or
/// in the plane; its origin `distance` times the triangle's size away.
inline Ray aim(std::mt19937& random, const Triangle& target, float distance) {
  const Vec3f corners[3] = {target.v0, target.v1, target.v2};
  const std::size_t i = random() % 3;
  const Vec3f a = corners[i], b = corners[(i + 1) % 3], c = corners[(i + 2) % 3];
  const auto largest = [](const Vec3f& e) { return std::max({std::abs(e.x), std::abs(e.y), std::abs(e.z)}); };
  const float size = std::max(largest(b - a), largest(c - a));
  const float s = uniform(random, 0.0f, 1.0f), r = uniform(random, 0.0f, 1.0f);
  Vec3f at, away;
  switch (random() % 5) {
    case 0:
      at = a;
      away = uniform_point(random, 1.0f);
      break;
    case 1:
      at = a + s * (b - a);
      away = uniform_point(random, 1.0f);
      break;
    case 2:
      at = a + s * (b - a) + r * (1.0f - s) * (c - a);
      away = uniform_point(random, 1.0f);
      break;
    case 3:
      at = a;
      away = (1.0f / largest(b - a)) * (b - a);
      break;
    default:
      at = a + s * (b - a);
      away = (1.0f / largest(c - a)) * (c - a) + uniform_point(random, 1e-6f);
      break;
  }
  const Vec3f origin = at + distance * size * away;
  return {.origin = origin, .direction = at - origin};
}

}  // namespace adversarial
