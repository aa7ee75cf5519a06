// The seed's setting: a binary tree, traversed by the speculative while-while kernel of Aila & Laine 2009.
#pragma once

#include "binary_layout.hpp"
#include "traversal.hpp"

namespace kerf::cuda {

/// The planes of a node's boxes as a ray meets them: each is entered or left by the ray's direction.
struct RayPlanes {
  float to_lower[3], to_upper[3];

  KERF_CUDA_INLINE void set(const TracedRay& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool negative = (ray.octant >> axis) & 1;
      to_lower[axis] = negative ? ray.boxes.leave[axis] : ray.boxes.enter[axis];
      to_upper[axis] = negative ? ray.boxes.enter[axis] : ray.boxes.leave[axis];
    }
  }

  /// Whether the ray meets the box in [t_min, t_max], and from where on.
  KERF_CUDA_INLINE bool meet(const TracedRay& ray, const Words4& xy, std::uint32_t lower_z,
                             std::uint32_t upper_z, float t_min, float t_max, float& enter) const {
    const float x0 = fused_multiply_add(as_float(xy.x), ray.boxes.inverse[0], to_lower[0]);
    const float x1 = fused_multiply_add(as_float(xy.y), ray.boxes.inverse[0], to_upper[0]);
    const float y0 = fused_multiply_add(as_float(xy.z), ray.boxes.inverse[1], to_lower[1]);
    const float y1 = fused_multiply_add(as_float(xy.w), ray.boxes.inverse[1], to_upper[1]);
    const float z0 = fused_multiply_add(as_float(lower_z), ray.boxes.inverse[2], to_lower[2]);
    const float z1 = fused_multiply_add(as_float(upper_z), ray.boxes.inverse[2], to_upper[2]);
    enter = maximum(maximum(minimum(x0, x1), minimum(y0, y1)), maximum(minimum(z0, z1), t_min));
    const float leave = minimum(minimum(maximum(x0, x1), maximum(y0, y1)), minimum(maximum(z0, z1), t_max));
    return enter <= leave;
  }
};

/// A ray on its way. Where single precision leaves open which hit is the nearest, `exact` decides it at once;
/// else that is done at the end, if it still matters then.
template <bool any_hit, bool exact = false, bool counting = false>
struct BinaryTraversal {
  using Hierarchy = BinaryHierarchy;
  // Apart, so that everything else stays in registers.
  struct Stack {
    std::uint32_t link[max_depth + 1];
  };

  NearestHit nearest{};
  Counters counters;

  /// Whether something is still open at the end: of the triangle `rival`, or of several if that is none.
  KERF_CUDA_INLINE bool open() const {
    return any_hit ? !nearest.found() && open_ < decided_t : open_ <= nearest.last;
  }

  KERF_CUDA_INLINE void start(const BinaryHierarchy& hierarchy, const TracedRay& ray) {
    nearest = no_hit(ray);
    link_ = hierarchy.node_count == 0 ? no_link : 0;
    leaf_ = 0;
    depth_ = 0;
    open_ = decided_t;
    rival_ = invalid_id;
    planes_.set(ray);
  }

  /// Down to a leaf and through its triangles. False when nothing is left.
  KERF_CUDA_INLINE bool step(const BinaryHierarchy& hierarchy, const TracedRay& ray, Stack& stack) {
    while (link_ < no_link) {
      visit_node(hierarchy, ray, stack);
      // A lane that has found a leaf goes on to the next node while others still look for theirs.
      postpone_leaf(stack);
      if (!any_lane(leaf_ == 0)) break;
    }
    postpone_leaf(stack);
    while (leaf_ != 0) {
      const std::uint32_t count = leaf_count(leaf_);
      const std::uint32_t first = leaf_first(leaf_);
      if constexpr (counting) counters.triangles += count;
      for (std::uint32_t i = 0; i < count; ++i) {
        const float open = test_triangle<any_hit>(ray, hierarchy.triangles, first + i, nearest);
        if constexpr (exact) {
          if (open < decided_t) nearest = nearer_of(ray.source, hierarchy.triangles, first + i, nearest);
        } else {
          if (open < decided_t) remember(hierarchy.triangles, first + i, open);
        }
        if (any_hit && nearest.found()) return false;
      }
      leaf_ = 0;
      postpone_leaf(stack);
    }
    return link_ != no_link;
  }

  KERF_CUDA_INLINE std::uint32_t rival() const { return rival_; }

 private:
  KERF_CUDA_INLINE void remember(const DeviceTriangle* triangles, std::uint32_t place, float open) {
    const bool alone = !(open_ <= nearest.last) ||
                       (rival_ != invalid_id && number_of(triangles[rival_]) == number_of(triangles[place]));
    rival_ = alone ? place : invalid_id;
    open_ = alone ? open : minimum(open_, open);
  }

  KERF_CUDA_INLINE void visit_node(const BinaryHierarchy& hierarchy, const TracedRay& ray, Stack& stack) {
    if constexpr (counting) ++counters.nodes;
    const Words4* node = reinterpret_cast<const Words4*>(hierarchy.nodes + link_);
    const Words4 first = load(node), second = load(node + 1), z = load(node + 2), links = load(node + 3);
    float t_first, t_second;
    const bool in_first = planes_.meet(ray, first, z.x, z.y, ray.t_min, nearest.last, t_first);
    const bool in_second = planes_.meet(ray, second, z.z, z.w, ray.t_min, nearest.last, t_second);
    if (in_first && in_second) {
      const bool first_is_nearer = t_first <= t_second;
      link_ = first_is_nearer ? links.x : links.y;
      stack.link[depth_++] = first_is_nearer ? links.y : links.x;
    } else {
      link_ = in_first ? links.x : in_second ? links.y : pop(stack);
    }
  }

  KERF_CUDA_INLINE std::uint32_t pop(const Stack& stack) {
    return depth_ == 0 ? no_link : stack.link[--depth_];
  }

  KERF_CUDA_INLINE void postpone_leaf(const Stack& stack) {
    if (link_ < leaf_bit || leaf_ != 0) return;
    leaf_ = link_;
    link_ = pop(stack);
  }

  std::uint32_t link_, leaf_;  // `leaf_` waits to be tested; 0 is none
  std::uint32_t depth_;
  float open_;           // no triangle that single precision left open has a t below this
  std::uint32_t rival_;  // the only one of these that matters; `invalid_id` where several may
  RayPlanes planes_;
};

}  // namespace kerf::cuda
