#include "construction/presplit/evh.hpp"

#include <cmath>
#include <limits>

#include "construction/presplit/threshold.hpp"

namespace kerf {
namespace {

struct EdgeVolumeRule {
  const Geometry& geometry;

  // A vertex made by halving an edge is rounded. The box around where it may truly be is kept in its place,
  // so that the boxes of the parts together hold every point of the triangle.
  struct TrianglePart {
    Box3f corners[3];
    Box3f triangle;  // the box of the whole triangle, which limits that of each part
  };

  TrianglePart whole(const Reference& reference) const {
    const Triangle t = geometry.triangle(reference.primitive);
    return {{{t.v0, t.v0}, {t.v1, t.v1}, {t.v2, t.v2}}, reference.bounds()};
  }

  static double volume(const Box3f& box) {
    return (double{box.upper.x} - box.lower.x) * (double{box.upper.y} - box.lower.y) *
           (double{box.upper.z} - box.lower.z);
  }

  static double edge_volume(const TrianglePart& part, int edge) {
    return volume(merge(part.corners[edge], part.corners[(edge + 1) % 3]));
  }

  static int largest_edge(const TrianglePart& part) {
    int largest = 0;
    for (int edge = 1; edge < 3; ++edge) {
      if (edge_volume(part, edge) > edge_volume(part, largest)) largest = edge;
    }
    return largest;
  }

  double size(const TrianglePart& part) const { return edge_volume(part, largest_edge(part)); }

  // Sums commute, so both triangles of an edge halve it at the same place whatever its direction: a mesh
  // without cracks still has none.
  static Box3f middle(const Box3f& a, const Box3f& b) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    Box3f box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::nextafter(0.5f * a.lower[axis] + 0.5f * b.lower[axis], -infinity);
      box.upper[axis] = std::nextafter(0.5f * a.upper[axis] + 0.5f * b.upper[axis], infinity);
    }
    return intersect(box, merge(a, b));
  }

  bool cut(const TrianglePart& part, TrianglePart& left, TrianglePart& right) const {
    const int edge = largest_edge(part), next = (edge + 1) % 3;
    const Box3f half = middle(part.corners[edge], part.corners[next]);
    left = right = part;
    left.corners[next] = half;
    right.corners[edge] = half;
    // Without rounding an eighth of the volume is left. Where more than half is left, the ends of the edge
    // are neighbouring floats.
    const double enough = 0.5 * edge_volume(part, edge);
    return edge_volume(left, edge) <= enough && edge_volume(right, edge) <= enough;
  }

  Box3f bounds(const TrianglePart& part) const {
    return intersect(merge(merge(part.corners[0], part.corners[1]), part.corners[2]), part.triangle);
  }
};

}  // namespace

std::vector<Reference> split_by_edge_volume(const Geometry& geometry, std::vector<Reference> references,
                                            std::size_t limit) {
  return split_above_threshold(EdgeVolumeRule{geometry}, std::move(references), limit);
}

BinaryTree construct_evh(const Geometry& geometry, const BuildOptions& options) {
  return construct_presplit(geometry, options, split_by_edge_volume);
}

}  // namespace kerf
