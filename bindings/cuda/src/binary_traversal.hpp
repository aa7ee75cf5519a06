// The seed's setting: a binary tree, traversed by the speculative while-while kernel of Aila & Laine 2009.
#pragma once

#include "binary_layout.hpp"
#include "hit_search.hpp"

namespace kerf::cuda {

/// A ray on its way.
template <bool any_hit, bool exact = false, bool counting = false>
struct BinaryTraversal {
  // Apart, so that everything else stays in registers. `no_link` lies at the bottom.
  struct Stack {
    std::uint32_t link[max_depth + 2];
  };

  HitSearch<any_hit, exact, counting> search;

  /// To the end of the ray.
  KERF_CUDA_INLINE void run(const BinaryHierarchy& hierarchy, const TracedRay& ray, Stack& stack) {
    link_ = hierarchy.node_count != 0 ? 0 : no_link;
    leaf_ = 0;
    stack.link[0] = no_link;
    top_ = stack.link;
    do {
      while (link_ < no_link) {
        visit_node(hierarchy, ray);
        postpone_leaf();
        // A lane that has found a leaf goes on to the next node while others still look for theirs.
        if (!any_lane(leaf_ == 0)) break;
      }
      postpone_leaf();
      while (leaf_ != 0) {
        const bool done =
            search.test(ray, hierarchy.bounds, hierarchy.triangles, leaf_first(leaf_), leaf_count(leaf_));
        leaf_ = 0;
        // Not by a return, which would leave the warp's other lanes to go on apart from each other.
        if (done) link_ = no_link;
        postpone_leaf();
      }
    } while (link_ != no_link);
  }

 private:
  // Without branches: whether to push or to pop differs from lane to lane.
  KERF_CUDA_INLINE void visit_node(const BinaryHierarchy& hierarchy, const TracedRay& ray) {
    if constexpr (counting) ++search.counters.nodes;
    const Words4* node = reinterpret_cast<const Words4*>(hierarchy.nodes + link_);
    const Words4 first = load(node), second = load(node + 1), z = load(node + 2), links = load(node + 3);
    const float t_max = search.nearest.last;
    float t_first, t_second;
    const bool in_first = ray.boxes.meet(first, z.x, z.y, ray.t_min, t_max, t_first);
    const bool in_second = ray.boxes.meet(second, z.z, z.w, ray.t_min, t_max, t_second);
    const bool second_is_next = in_second && !(in_first && t_first <= t_second);
    link_ = second_is_next ? links.y : links.x;
    if (in_first && in_second) *++top_ = second_is_next ? links.x : links.y;
    if (!in_first && !in_second) link_ = *top_--;
  }

  KERF_CUDA_INLINE void postpone_leaf() {
    if (link_ < leaf_bit || leaf_ != 0) return;
    leaf_ = link_;
    link_ = *top_--;
  }

  std::uint32_t link_, leaf_;  // `leaf_` waits to be tested; 0 is none
  std::uint32_t* top_;         // of the stack
};

}  // namespace kerf::cuda
