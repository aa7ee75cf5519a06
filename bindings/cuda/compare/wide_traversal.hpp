// The traversal of the wide tree, after Ylitie, Karras & Laine 2017: the children that a ray meets are kept
// as a mask, in an order that the signs of its direction give.
#pragma once

#include "../src/hit_search.hpp"
#include "wide_layout.hpp"

namespace kerf::cuda {

KERF_CUDA_INLINE std::uint32_t count_bits(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return static_cast<std::uint32_t>(__popc(bits));
#else
  return static_cast<std::uint32_t>(__builtin_popcount(bits));
#endif
}

template <bool any_hit, bool exact = false, bool counting = false>
struct WideTraversal {
  // Nodes side by side of which some are still to be visited.
  struct Group {
    std::uint32_t first;  // number of the first of them
    std::uint32_t masks;  // bits 0 to 7: slots that are nodes; bits 8 to 15: order in which they are to come
  };
  struct Stack {
    Group group[max_depth + 1];
  };

  HitSearch<any_hit, exact, counting> search;

  /// To the end of the ray.
  KERF_CUDA_INLINE void run(const WideHierarchy& hierarchy, const TracedRay& ray, Stack& stack) {
    start(hierarchy, ray, stack);
    while (step(hierarchy, ray)) {
    }
  }

 private:
  KERF_CUDA_INLINE void start(const WideHierarchy& hierarchy, const TracedRay& ray, Stack& stack) {
    octant_ = 0;
    for (int axis = 0; axis < 3; ++axis)
      octant_ |= static_cast<std::uint32_t>(ray.boxes.backward[axis] < 0.0f) << axis;
    // The root as the only node of its group, in the slot that is last in order.
    group_ = {0, hierarchy.node_count == 0 ? 0u : (1u << 8) | (1u << octant_)};
    stack_ = stack.group;
    depth_ = 0;
  }

  /// Into one node. False when nothing is left.
  KERF_CUDA_INLINE bool step(const WideHierarchy& hierarchy, const TracedRay& ray) {
    if (group_.masks < (1u << 8)) {
      if (depth_ == 0) return false;
      group_ = stack_[--depth_];
    }
    const auto next = static_cast<std::uint32_t>(highest_bit(group_.masks));
    group_.masks ^= 1u << next;
    const std::uint32_t slot = (next - 8) ^ octant_;
    const std::uint32_t number = group_.first + count_bits(group_.masks & ((1u << slot) - 1) & 0xff);
    if (group_.masks >= (1u << 8)) stack_[depth_++] = group_;
    return visit_node(hierarchy, ray, number);
  }

  // The planes of one axis as the ray meets them.
  struct Axis {
    float forward, backward, enter, leave;

    KERF_CUDA_INLINE Axis(const BoxConstants& boxes, int axis, std::uint32_t origin, std::uint32_t exponent) {
      const float step = as_float((exponent & 0xff) << 23), from = as_float(origin);
      const float inverse = boxes.forward[axis] + boxes.backward[axis];
      forward = boxes.forward[axis] * step;
      backward = boxes.backward[axis] * step;
      enter = fused_multiply_add(from, inverse, boxes.enter[axis]);
      leave = fused_multiply_add(from, inverse, boxes.leave[axis]);
    }
    KERF_CUDA_INLINE float entry(float lower, float upper) const {
      return fused_multiply_add(lower, forward, fused_multiply_add(upper, backward, enter));
    }
    KERF_CUDA_INLINE float exit(float lower, float upper) const {
      return fused_multiply_add(upper, forward, fused_multiply_add(lower, backward, leave));
    }
  };

  KERF_CUDA_INLINE static std::uint32_t byte_of(std::uint32_t low, std::uint32_t high, int i) {
    return ((i < 4 ? low : high) >> (8 * (i & 3))) & 0xff;
  }

  KERF_CUDA_INLINE bool visit_node(const WideHierarchy& hierarchy, const TracedRay& ray,
                                   std::uint32_t number) {
    if constexpr (counting) ++search.counters.nodes;
    const Words4* node = reinterpret_cast<const Words4*>(hierarchy.nodes + number);
    const Words4 head = load(node), links = load(node + 1), px = load(node + 2), py = load(node + 3),
                 pz = load(node + 4);
    const Axis x(ray.boxes, 0, head.x, head.w), y(ray.boxes, 1, head.y, head.w >> 8),
        z(ray.boxes, 2, head.z, head.w >> 16);
    std::uint32_t met = 0;
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
    for (int i = 0; i < 8; ++i) {
      const auto lower_x = static_cast<float>(byte_of(px.x, px.y, i)),
                 upper_x = static_cast<float>(byte_of(px.z, px.w, i)),
                 lower_y = static_cast<float>(byte_of(py.x, py.y, i)),
                 upper_y = static_cast<float>(byte_of(py.z, py.w, i)),
                 lower_z = static_cast<float>(byte_of(pz.x, pz.y, i)),
                 upper_z = static_cast<float>(byte_of(pz.z, pz.w, i));
      const float first =
          maximum(largest_of(x.entry(lower_x, upper_x), y.entry(lower_y, upper_y), z.entry(lower_z, upper_z)),
                  ray.t_min);
      const float last =
          minimum(smallest_of(x.exit(lower_x, upper_x), y.exit(lower_y, upper_y), z.exit(lower_z, upper_z)),
                  search.nearest.last);
      if (first <= last && byte_of(links.z, links.w, i) != 0)
        met |= 1u << (static_cast<std::uint32_t>(i) ^ octant_);
    }
    const std::uint32_t inner = head.w >> 24;
    std::uint32_t nodes = 0;
    while (met != 0) {
      const auto next = static_cast<std::uint32_t>(highest_bit(met));
      met ^= 1u << next;
      const std::uint32_t slot = next ^ octant_;
      if (((inner >> slot) & 1) != 0) {
        nodes |= 1u << next;
        continue;
      }
      const std::uint32_t kind = ((slot < 4 ? links.z : links.w) >> (8 * (slot & 3))) & 0xff;
      if (search.test(ray, hierarchy.bounds, hierarchy.triangles, links.y + wide_leaf_offset(kind),
                      wide_leaf_count(kind)))
        return false;
    }
    group_ = {links.x, (nodes << 8) | inner};
    return true;
  }

  Group group_;
  Group* stack_;
  std::uint32_t depth_, octant_;
};

}  // namespace kerf::cuda
