#include "tree/polygon.hpp"

#include <gtest/gtest.h>

#include "tree/geometry.hpp"
#include "tree/measures/sample_trees.hpp"

namespace kerf {
namespace {

TEST(Polygon, ClippedAreasOfTheCellsOfAGridSumToThatOfTheTriangle) {
  const Soup soup = random_soup(50, 1.0f, 2);
  const TriangleMesh mesh = soup.mesh();
  const Geometry geometry({&mesh, 1});
  for (std::uint32_t id = 0; id < geometry.triangle_count(); ++id) {
    const Polygon polygon(geometry.triangle(id));
    double sum = 0.0;
    for (float x = -2; x < 3; x += 0.5f) {
      for (float y = -2; y < 3; y += 0.5f) {
        for (float z = -2; z < 3; z += 0.5f) {
          sum += clip(polygon, Box3f{{x, y, z}, {x + 0.5f, y + 0.5f, z + 0.5f}}).area();
        }
      }
    }
    EXPECT_NEAR(sum, polygon.area(), 1e-12);
  }
}

}  // namespace
}  // namespace kerf
