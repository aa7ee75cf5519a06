// The leaves along a line, depth first.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_LINES_LINE_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_LINES_LINE_WALK_INL_H
#undef KERF_TRAVERSAL_LINES_LINE_WALK_INL_H
#else
#define KERF_TRAVERSAL_LINES_LINE_WALK_INL_H
#endif

#include <bit>

#include <hwy/highway.h>

#include "traversal/lines/line_leaf-inl.h"
#include "traversal/node-inl.h"
#include "traversal/rays/node_step-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// No step depends on what was found, so that several nodes are stepped at once, as for rays.
constexpr std::size_t nodes_per_line_step = 3;

// Calls `visit(leaf)` for each leaf whose box the ray meets, until it returns false.
template <class Visit>
HWY_INLINE void walk_line(const WideBvh& bvh, const LineRay& line, Visit&& visit) {
  const NodeConstants constants(line.wide);
  const std::uint32_t octant = line.wide.octant;
  const BoxVector t_max = box_vector(line.t_max);
  Stack<nodes_per_line_step> stack;
  stack.link[0] = stack.bottom;
  std::size_t depth = 1;
  ChildLink link = ChildLink::node(0);
  while (true) {
    bool at_leaf = true;
    while (!link.is_leaf()) {
      const Node& node = node_at(bvh, link.node());
      const Spans spans = meet_boxes<false>(constants, t_max, node);
      step_next<true, false, false, nodes_per_line_step - 1>(bvh, constants, octant, t_max, line.t_max, stack,
                                                             depth, nullptr);
      const std::uint32_t met = less_or_equal(spans.first, spans.last);
      if (met == 0) {
        at_leaf = false;
        break;
      }
      if ((met & (met - 1)) == 0) {
        link = node.children[std::countr_zero(met)];
        continue;
      }
      std::uint32_t nearest;
      push_children<true>(node, spans, met, octant, stack, depth, nearest);
      --depth;
      link = ChildLink(nearest);
    }
    if (at_leaf && !visit(link)) return;
    if (depth == 1) return;
    link = ChildLink(stack.link[--depth]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
