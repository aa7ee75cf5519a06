#include "workbench/scene/placed.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "workbench/generate/solids.hpp"
#include "workbench/sampling/random.hpp"

namespace workbench {
namespace {

// Turned by an angle about z and then about x, scaled, and moved.
kerf::Transform transform_of(RandomNumbers& random) {
  const double a = 6.0 * random.uniform(), b = 6.0 * random.uniform(), scale = 0.2 + random.uniform();
  const double rows[3][3] = {{std::cos(a), -std::sin(a), 0.0},
                             {std::cos(b) * std::sin(a), std::cos(b) * std::cos(a), -std::sin(b)},
                             {std::sin(b) * std::sin(a), std::sin(b) * std::cos(a), std::cos(b)}};
  kerf::Transform transform;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) transform.rows[i][k] = scale * rows[i][k];
    transform.rows[i][3] = 10.0 * random.uniform();
  }
  return transform;
}

TEST(Placed, BoundsAreThoseOfOneMeshOfAllCopies) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    RandomNumbers random(seed);
    PlacedMeshes placed;
    for (Solid solid : {make_torus(24, 12), make_box({-1, -2, -3}, {1, 2, 3}, 2)}) {
      // A triangle without area far away counts for neither.
      const auto far = static_cast<std::uint32_t>(solid.vertices.size());
      solid.vertices.push_back({1e3f, 1e3f, 1e3f});
      solid.triangles.push_back({0, far, far});
      placed.meshes.push_back({.vertices = solid.vertices, .triangles = solid.triangles});
    }
    for (std::uint32_t i = 0; i < 1 + seed; ++i)
      placed.places.push_back({.mesh = i % 2, .transform = transform_of(random)});
    const PlacedMeshes::Mesh all = flattened(placed, placed.triangle_count());
    EXPECT_EQ(bounds_of(placed, build_objects(placed)), kerf::build(all.mesh()).bounds()) << seed;
  }
}

}  // namespace
}  // namespace workbench
