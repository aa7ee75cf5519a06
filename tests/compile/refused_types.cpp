// What must not compile, one case a number: cmake/KerfRefusedTypes.cmake compiles each and reads the message.
#include <array>
#include <vector>

#include <kerf/kerf.hpp>

int main() {
  const std::vector<std::array<float, 3>> points;
  const std::vector<std::array<double, 3>> double_points;
  const std::vector<std::array<unsigned, 4>> quadrilaterals;
  const std::vector<std::array<unsigned long long, 3>> long_triangles;
#if KERF_CASE == 0  // compiles: what the others have in common is right
  const kerf::TriangleMesh mesh{.vertices = points, .triangles = {}};
#elif KERF_CASE == 1
  const kerf::TriangleMesh mesh{.vertices = double_points, .triangles = {}};
#elif KERF_CASE == 2
  const kerf::TriangleMesh mesh{.vertices = points, .triangles = long_triangles};
#elif KERF_CASE == 3
  const kerf::TriangleMesh mesh{.vertices = points, .triangles = quadrilaterals};
#elif KERF_CASE == 4
  const kerf::TriangleMesh mesh{.vertices = std::vector<std::array<float, 3>>(3), .triangles = {}};
#elif KERF_CASE == 5
  const double scalars[3]{};
  const kerf::TriangleMesh mesh{.vertices = {scalars, 1, sizeof scalars}, .triangles = {}};
#endif
  return static_cast<int>(mesh.vertices.size());
}
