// What both ways of splitting before the build were made for.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/mesh.hpp>

namespace kerf {

/// Long thin triangles at all angles.
class LongTriangles : public testing::Test {
 protected:
  LongTriangles() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-1.0f, 1.0f);
    for (std::uint32_t i = 0; i < 500; ++i) {
      const std::array<float, 3> a{place(random), place(random), place(random)};
      vertices.push_back(a);
      vertices.push_back({a[0] + 0.01f, a[1], a[2] + 0.01f * place(random)});
      vertices.push_back({place(random), place(random), place(random)});
      triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
  }

  TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }

  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace kerf
