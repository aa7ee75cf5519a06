// Trees for the tests of measures.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <kerf/mesh.hpp>

#include "tree/binary_tree.hpp"

namespace kerf {

struct Soup {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

inline Soup random_soup(std::uint32_t count, float size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0.0f, 1.0f), offset(-size, size);
  Soup soup;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::array<float, 3> centre{place(random), place(random), place(random)};
    for (int k = 0; k < 3; ++k) {
      soup.vertices.push_back(
          {centre[0] + offset(random), centre[1] + offset(random), centre[2] + offset(random)});
    }
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return soup;
}

/// Two leaves that each hold half of the unit cube, with one triangle each, both of area 1/4 in the plane
/// z = 0.5. The left triangle lies in the left half. Of the right triangle, 3/4 lie in the right half and the
/// rest in the left leaf's box.
struct TwoHalves {
  Soup soup{{{0, 0, 0.5f}, {0.5f, 0, 0.5f}, {0, 1, 0.5f}, {1, 0, 0.5f}, {1, 0.5f, 0.5f}, {0, 0.5f, 0.5f}},
            {{0, 1, 2}, {3, 4, 5}}};
  BinaryTree tree{.nodes = {{{{0, 0, 0}, {1, 1, 1}}, 1, 0},
                            {{{0, 0, 0}, {0.5f, 1, 1}}, 0, 1},
                            {{{0.5f, 0, 0}, {1, 1, 1}}, 1, 1}},
                  .references = {0, 1}};
};

}  // namespace kerf
