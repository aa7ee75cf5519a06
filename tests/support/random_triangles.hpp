// Meshes without structure, for tests that must hold for any.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <kerf/mesh.hpp>
#include <kerf/vec.hpp>

namespace kerf_tests {

struct Mesh {
  std::vector<kerf::Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  kerf::TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

/// `count` separate triangles in a cube of side 1 at `corner`: edges of up to `length` long and `width` wide.
inline Mesh random_triangles(std::uint32_t count, float length, float width, std::uint32_t seed = 1,
                             kerf::Vec3f corner = {}) {
  std::mt19937 random(seed);
  const auto uniform = [&random](float from, float to) {
    return from + (to - from) * (static_cast<float>(random() >> 8) / 16777216.0f);
  };
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const kerf::Vec3f a{corner.x + uniform(0, 1), corner.y + uniform(0, 1), corner.z + uniform(0, 1)};
    const auto near_a = [&](float size) {
      return kerf::Vec3f{a.x + uniform(-size, size), a.y + uniform(-size, size), a.z + uniform(-size, size)};
    };
    mesh.vertices.insert(mesh.vertices.end(), {a, near_a(length), near_a(width)});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// Large triangles across the axes among many small ones: spatial splits divide the large ones.
inline Mesh large_among_small(std::uint32_t count) {
  Mesh mesh = random_triangles(count, 0.02f, 0.02f);
  const Mesh large = random_triangles(count, 0.7f, 0.7f, 2);
  for (std::uint32_t i = 0; i < 3 * count; ++i)
    if (i / 3 % 8 == 0) mesh.vertices[i] = large.vertices[i];
  return mesh;
}

}  // namespace kerf_tests
