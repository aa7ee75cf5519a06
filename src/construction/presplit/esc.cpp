#include "construction/presplit/presplit.hpp"
#include "construction/presplit/threshold.hpp"
#include "math/clip.hpp"

namespace kerf {
namespace {

struct AreaRule {
  const Geometry& geometry;

  struct Part {
    Box3f box;
    std::uint32_t primitive = 0;
  };

  Part whole(const Reference& reference) const { return {reference.bounds(), reference.primitive}; }

  double size(const Part& part) const {
    const double x = double{part.box.upper.x} - part.box.lower.x;
    const double y = double{part.box.upper.y} - part.box.lower.y;
    const double z = double{part.box.upper.z} - part.box.lower.z;
    return 2.0 * (x * (y + z) + y * z);
  }

  bool cut(const Part& part, Part& left, Part& right) const {
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

  Box3f bounds(const Part& part) const { return part.box; }
};

}  // namespace

std::vector<Reference> split_by_area(const Geometry& geometry, std::vector<Reference> references,
                                     std::size_t limit) {
  return split_before_build(AreaRule{geometry}, std::move(references), limit);
}

}  // namespace kerf
