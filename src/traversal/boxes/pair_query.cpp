#include <algorithm>
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

#include "simd/fallback-inl.h"

#include "traversal/boxes/box_overlap-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

namespace {

// Both hierarchies are descended at once: a child's box of the second, moved, is tested against all children
// of a node of the first. The nodes of the second may have another width, if it was built for another
// instruction set.
template <class SecondNode>
class PairSearch {
 public:
  HWY_INLINE PairSearch(const WideBvh& first, const WideBvh& second, const Motion& motion)
      : first_(first), second_(second), second_nodes_(second.nodes<SecondNode>()), motion_(motion) {}

  // Puts the pairs of children that meet behind `waiting`. One of the pair must be a node.
  HWY_INLINE void open(const BoxPair pair, std::vector<BoxPair>& waiting) const {
    if (pair.second.is_leaf()) {
      push_children(pair.first, pair.second, pair.second_box, waiting);
      return;
    }
    const SecondNode& node = second_nodes_[pair.second.node()];
    for (std::uint32_t slot = 0; slot < SecondNode::width; ++slot) {
      const Box3f own = child_box(node, slot);
      if (own.empty()) continue;
      const Box3f box = motion_(own);
      if (!pair.first.is_leaf()) {
        push_children(pair.first, node.children[slot], box, waiting);
      } else if (!intersect(pair.first_box, box).empty()) {
        waiting.push_back({pair.first, node.children[slot], pair.first_box, box});
      }
    }
  }

  // Visits the triangles of two leaves that touch. False if `visit` returned it.
  HWY_INLINE bool visit_leaves(const BoxPair& pair, void* visitor,
                               bool (*visit)(void*, std::uint32_t, std::uint32_t)) const {
    for (std::uint32_t k = 0; k < pair.second.count(); ++k) {
      const Triangle moved = motion_(triangle_in(second_, pair.second, k));
      for (std::uint32_t rest = bounds_in(first_, pair.first, bounds_of(moved)); rest != 0;
           rest &= rest - 1) {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
        if (triangles_touch(triangle_in(first_, pair.first, i), moved) &&
            !visit(visitor, triangle_id(first_, pair.first, i), triangle_id(second_, pair.second, k)))
          return false;
      }
    }
    return true;
  }

 private:
  // The children of a node of the first that meet the box, each beside `link` of the second.
  HWY_INLINE void push_children(ChildLink node, ChildLink link, const Box3f& box,
                                std::vector<BoxPair>& waiting) const {
    const Node& parent = node_at(first_, node.node());
    for (std::uint32_t rest = children_in(parent, box); rest != 0; rest &= rest - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
      waiting.push_back({parent.children[i], link, child_box(parent, i), box});
    }
  }

  const WideBvh& first_;
  const WideBvh& second_;
  const SecondNode* second_nodes_;
  const Motion& motion_;
};

bool of_leaves(const BoxPair& pair) {
  return pair.first.is_leaf() && pair.second.is_leaf();
}

}  // namespace

std::vector<BoxPair> open_pairs(const WideBvh& first, const WideBvh& second, const Motion& motion,
                                const BoxPair& start, std::size_t wanted) {
  std::vector<BoxPair> pairs{start};
  with_width(second.width, [&](auto width) HWY_ATTR {
    const PairSearch<WideNode<width>> search(first, second, motion);
    // All pairs one step further, again and again.
    std::vector<BoxPair> opened;
    while (pairs.size() < wanted && !std::all_of(pairs.begin(), pairs.end(), of_leaves)) {
      opened.clear();
      for (const BoxPair& pair : pairs) {
        if (of_leaves(pair)) {
          opened.push_back(pair);
        } else {
          search.open(pair, opened);
        }
      }
      pairs.swap(opened);
    }
  });
  return pairs;
}

void visit_pairs(const WideBvh& first, const WideBvh& second, const Motion& motion, const BoxPair& start,
                 void* visitor, bool (*visit)(void* visitor, std::uint32_t first, std::uint32_t second)) {
  with_width(second.width, [&](auto width) HWY_ATTR {
    const PairSearch<WideNode<width>> search(first, second, motion);
    std::vector<BoxPair> waiting{start};
    while (!waiting.empty()) {
      const BoxPair pair = waiting.back();
      waiting.pop_back();
      if (!of_leaves(pair)) {
        search.open(pair, waiting);
      } else if (!search.visit_leaves(pair, visitor, visit)) {
        return;
      }
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

KERF_EXPORT_KERNEL(open_pairs);
KERF_EXPORT_KERNEL(visit_pairs);

}  // namespace kerf
#endif
