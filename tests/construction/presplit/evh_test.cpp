#include "construction/presplit/evh.hpp"

#include <algorithm>

#include "construction/input.hpp"
#include "construction/presplit/long_triangles.hpp"

namespace kerf {
namespace {

class Evh : public LongTriangles {};

TEST_F(Evh, NeverCutsATriangleWhoseEdgesAreFlat) {
  vertices.insert(vertices.end(), {{-9, -9, 0}, {9, -9, 0}, {-9, 9, 0}});
  triangles.push_back({1500, 1501, 1502});
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  const auto parts = split_by_edge_volume(geometry, make_references(geometry).references, 3000);
  EXPECT_EQ(std::count_if(parts.begin(), parts.end(), [](const Reference& r) { return r.primitive == 500; }),
            1);
}

}  // namespace
}  // namespace kerf
