#include <bit>

#include "layout/wide_bvh.hpp"
#include "simd/targets.hpp"
#include "traversal/dispatch.hpp"
#include "tree/binary_tree.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/boxes/box_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "traversal/boxes/box_overlap-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

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

#if HWY_ONCE
namespace kerf {

KERF_EXPORT_KERNEL(visit_box);

}  // namespace kerf
#endif
