#include <bit>

#include "layout/wide_bvh.hpp"
#include "simd/targets.hpp"
#include "traversal/dispatch.hpp"
#include "tree/binary_tree.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/boxes/box_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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

void visit_box(const WideBvh& bvh, const Box3f& box, void* visitor,
               bool (*visit)(void* visitor, ChildLink leaf, std::uint32_t place)) {
  ChildLink waiting[node_width * max_tree_depth];
  std::size_t depth = 0;
  waiting[depth++] = ChildLink::node(0);
  while (depth != 0) {
    const ChildLink link = waiting[--depth];
    if (link.is_leaf()) {
      for (std::uint32_t rest = bounds_in(bvh, link, box); rest != 0; rest &= rest - 1) {
        if (!visit(visitor, link, static_cast<std::uint32_t>(std::countr_zero(rest)))) return;
      }
    } else {
      const Node& node = node_at(bvh, link.node());
      for (std::uint32_t rest = children_in(node, box); rest != 0; rest &= rest - 1)
        waiting[depth++] = node.children[std::countr_zero(rest)];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();
