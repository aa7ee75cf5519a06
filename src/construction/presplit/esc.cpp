#include "construction/presplit/esc.hpp"

#include "construction/presplit/threshold.hpp"
#include "math/clip.hpp"

namespace kerf {
namespace {

struct AreaRule {
  const Geometry& geometry;

  struct TrianglePart {
    Box3f box;
    std::uint32_t primitive = 0;
  };

  TrianglePart whole(const Reference& reference) const { return {reference.bounds(), reference.primitive}; }

  double size(const TrianglePart& part) const {
    const double x = double{part.box.upper.x} - part.box.lower.x;
    const double y = double{part.box.upper.y} - part.box.lower.y;
    const double z = double{part.box.upper.z} - part.box.lower.z;
    return 2.0 * (x * (y + z) + y * z);
  }

  bool cut(const TrianglePart& part, TrianglePart& left, TrianglePart& right) const {
    const Vec3f size = extent(part.box);
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const float plane = 0.5f * part.box.lower[axis] + 0.5f * part.box.upper[axis];
    if (!(part.box.lower[axis] < plane && plane < part.box.upper[axis])) return false;
    const ChoppedBoxes boxes = chop(geometry.triangle(part.primitive), part.box, axis, plane);
    if (boxes.left.empty() || boxes.right.empty()) return false;
    left = {boxes.left, part.primitive};
    right = {boxes.right, part.primitive};
    return true;
  }

  Box3f bounds(const TrianglePart& part) const { return part.box; }
};

}  // namespace

std::vector<Reference> split_by_area(const Geometry& geometry, std::vector<Reference> references,
                                     std::size_t limit) {
  return split_above_threshold(AreaRule{geometry}, std::move(references), limit);
}

BinaryTree construct_esc(const Geometry& geometry, const BuildOptions& options) {
  return construct_presplit(geometry, options, split_by_area);
}

}  // namespace kerf
