// What of a node and of a leaf has a point in a box.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_BOXES_BOX_OVERLAP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_BOXES_BOX_OVERLAP_INL_H
#undef KERF_TRAVERSAL_BOXES_BOX_OVERLAP_INL_H
#else
#define KERF_TRAVERSAL_BOXES_BOX_OVERLAP_INL_H
#endif

#include <hwy/highway.h>

#include "layout/wide_bvh.hpp"
#include "simd/floats-inl.h"
#include "traversal/node-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// The children whose boxes have a point in `box`. Unused slots, from +infinity to -infinity, have none.
HWY_INLINE std::uint32_t children_in(const Node& node, const Box3f& box) {
  std::uint32_t in = (1u << node_width) - 1;
  for (int axis = 0; axis < 3; ++axis) {
    in &= less_or_equal(load<node_width>(node.planes[axis][0]), broadcast<node_width>(box.upper[axis]));
    in &= less_or_equal(broadcast<node_width>(box.lower[axis]), load<node_width>(node.planes[axis][1]));
  }
  return in;
}

// The triangles of a leaf whose bounds have a point in `box`.
HWY_INLINE std::uint32_t bounds_in(const WideBvh& bvh, ChildLink leaf, const Box3f& box) {
  const std::uint32_t count = leaf.count();
  const float* rows = leaf_rows(bvh, leaf);
  std::uint32_t in = (1u << count) - 1;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const Float8 a = load(rows + axis * count), b = load(rows + (3 + axis) * count),
                 c = load(rows + (6 + axis) * count);
    in &= less_or_equal(minimum(minimum(a, b), c), broadcast(box.upper[static_cast<int>(axis)]));
    in &= less_or_equal(broadcast(box.lower[static_cast<int>(axis)]), maximum(maximum(a, b), c));
  }
  return in;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
