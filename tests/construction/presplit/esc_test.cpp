#include "construction/presplit/esc.hpp"

#include <algorithm>
#include <array>
#include <queue>
#include <set>

#include "construction/input.hpp"
#include "construction/presplit/long_triangles.hpp"
#include "math/clip.hpp"

namespace kerf {
namespace {

class Esc : public LongTriangles {};

TEST_F(Esc, CutsTheLargestBoxesFirst) {
  const TriangleMesh m = mesh();
  const Geometry geometry({&m, 1});
  const auto parts = split_by_area(geometry, make_references(geometry).references, 2000);

  // The oracle cuts the largest box there is until there are as many.
  struct Piece {
    Box3f box;
    std::uint32_t id;
    bool operator<(const Piece& other) const { return half_area(box) < half_area(other.box); }
  };
  std::priority_queue<Piece> queue;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) queue.push({bounds_of(geometry.triangle(i)), i});
  while (queue.size() < parts.size()) {
    const Piece piece = queue.top();
    queue.pop();
    const Vec3f e = extent(piece.box);
    const std::array<float, 3> size{e.x, e.y, e.z};
    const int axis = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
    const float middle = 0.5f * (piece.box.lower[axis] + piece.box.upper[axis]);
    const ChoppedBoxes halves = chop(geometry.triangle(piece.id), piece.box, axis, middle);
    queue.push({halves.left, piece.id});
    queue.push({halves.right, piece.id});
  }
  std::multiset<std::pair<std::uint32_t, float>> expected, actual;
  for (; !queue.empty(); queue.pop()) expected.insert({queue.top().id, half_area(queue.top().box)});
  for (const Reference& part : parts) actual.insert({part.primitive, half_area(part.bounds())});
  EXPECT_EQ(actual, expected);
}

}  // namespace
}  // namespace kerf
