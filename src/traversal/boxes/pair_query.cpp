#include <bit>
#include <vector>

#include "layout/wide_bvh.hpp"
#include "math/triangle.hpp"
#include "math/triangle_pair.hpp"
#include "simd/targets.hpp"
#include "traversal/dispatch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/boxes/pair_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "traversal/boxes/box_overlap-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

namespace {

// Both hierarchies are descended at once: a child's box of the second, moved, is tested against all children
// of a node of the first. The nodes of the second may have another width, if it was built for another
// instruction set.
template <class SecondNode>
void visit_node_pairs(const WideBvh& first, const WideBvh& second, const SecondNode* second_nodes,
                      const Motion& motion, void* visitor,
                      bool (*visit)(void* visitor, std::uint32_t first, std::uint32_t second)) {
  struct Pair {
    ChildLink first, second;
    Box3f first_box, second_box;  // the second is moved
  };
  std::vector<Pair> waiting{{ChildLink::node(0), ChildLink::node(0), first.bounds, motion(second.bounds)}};
  // Puts the children of a node of the first that meet the box beside `link` of the second.
  const auto wait_with_children = [&](ChildLink node, ChildLink link, const Box3f& box) HWY_ATTR {
    const Node& parent = node_at(first, node.node());
    for (std::uint32_t rest = children_in(parent, box); rest != 0; rest &= rest - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
      waiting.push_back({parent.children[i], link, child_box(parent, i), box});
    }
  };
  while (!waiting.empty()) {
    const Pair pair = waiting.back();
    waiting.pop_back();
    if (!pair.second.is_leaf()) {
      const SecondNode& node = second_nodes[pair.second.node()];
      for (std::uint32_t slot = 0; slot < SecondNode::width; ++slot) {
        const Box3f own = child_box(node, slot);
        if (own.empty()) continue;
        const Box3f box = motion(own);
        if (!pair.first.is_leaf()) {
          wait_with_children(pair.first, node.children[slot], box);
        } else if (!intersect(pair.first_box, box).empty()) {
          waiting.push_back({pair.first, node.children[slot], pair.first_box, box});
        }
      }
    } else if (!pair.first.is_leaf()) {
      wait_with_children(pair.first, pair.second, pair.second_box);
    } else {
      for (std::uint32_t k = 0; k < pair.second.count(); ++k) {
        const Triangle moved = motion(triangle_in(second, pair.second, k));
        for (std::uint32_t rest = bounds_in(first, pair.first, bounds_of(moved)); rest != 0;
             rest &= rest - 1) {
          const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
          if (triangles_touch(triangle_in(first, pair.first, i), moved) &&
              !visit(visitor, triangle_id(first, pair.first, i), triangle_id(second, pair.second, k)))
            return;
        }
      }
    }
  }
}

}  // namespace

void visit_pairs(const WideBvh& first, const WideBvh& second, const Motion& motion, void* visitor,
                 bool (*visit)(void* visitor, std::uint32_t first, std::uint32_t second)) {
  with_width(second.width, [&](auto width) {
    visit_node_pairs(first, second, second.nodes<WideNode<width>>(), motion, visitor, visit);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();
