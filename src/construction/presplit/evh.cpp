#include <cmath>

#include "construction/presplit/presplit.hpp"
#include "construction/presplit/threshold.hpp"

namespace kerf {
namespace {

struct EdgeVolumeRule {
  const Geometry& geometry;

  // A corner made by halving an edge is rounded; the box around where it may truly be is kept instead, so
  // that the boxes of the parts together hold every point of the triangle.
  struct Part {
    Box3f corners[3];
    Box3f triangle;  // the whole triangle's box, which no part reaches out of
  };

  Part whole(const Reference& reference) const {
    const Triangle t = geometry.triangle(reference.primitive);
    return {{{t.v0, t.v0}, {t.v1, t.v1}, {t.v2, t.v2}}, reference.bounds()};
  }

  static double volume(const Box3f& box) {
    return (double{box.upper.x} - box.lower.x) * (double{box.upper.y} - box.lower.y) *
           (double{box.upper.z} - box.lower.z);
  }

  static double edge_volume(const Part& part, int edge) {
    return volume(merge(part.corners[edge], part.corners[(edge + 1) % 3]));
  }

  static int largest_edge(const Part& part) {
    int largest = 0;
    for (int edge = 1; edge < 3; ++edge) {
      if (edge_volume(part, edge) > edge_volume(part, largest)) largest = edge;
    }
    return largest;
  }

  double size(const Part& part) const { return edge_volume(part, largest_edge(part)); }

  // Both triangles of an edge halve it at the same place whatever its direction, since sums commute: a mesh
  // without cracks has none after.
  static Box3f middle(const Box3f& a, const Box3f& b) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    Box3f box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::nextafter(0.5f * a.lower[axis] + 0.5f * b.lower[axis], -infinity);
      box.upper[axis] = std::nextafter(0.5f * a.upper[axis] + 0.5f * b.upper[axis], infinity);
    }
    return intersect(box, merge(a, b));
  }

  bool cut(const Part& part, Part& left, Part& right) const {
    const int edge = largest_edge(part), next = (edge + 1) % 3;
    const Box3f half = middle(part.corners[edge], part.corners[next]);
    left = right = part;
    left.corners[next] = half;
    right.corners[edge] = half;
    // An eighth, but for rounding; where so little is gained the ends are neighbours among floats.
    const double enough = 0.5 * edge_volume(part, edge);
    return edge_volume(left, edge) <= enough && edge_volume(right, edge) <= enough;
  }

  Box3f bounds(const Part& part) const {
    return intersect(merge(merge(part.corners[0], part.corners[1]), part.corners[2]), part.triangle);
  }
};

}  // namespace

std::vector<Reference> split_by_edge_volume(const Geometry& geometry, std::vector<Reference> references,
                                            std::size_t limit) {
  return split_before_build(EdgeVolumeRule{geometry}, std::move(references), limit);
}

}  // namespace kerf
