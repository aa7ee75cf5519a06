#include "traversal/rays/leaf_visits.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "layout/wide_bvh.hpp"
#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/rays/leaf_visits.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "traversal/node-inl.h"
#include "traversal/rays/node_step-inl.h"
#include "traversal/rays/prepared_ray.hpp"
#include "traversal/rays/wide_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Grows all boxes by `margin` units of 2^-24 of the distance to the far side of the scene.
HWY_INLINE void grow_boxes(WideRay& ray, float margin) {
  const float unit = ray.error() / std::abs(ray.inverse_dz());
  for (int axis = 0; axis < 3; ++axis) {
    const float grown = margin * unit * std::abs(ray.inverse[axis]);
    ray.enter[axis] -= grown;
    ray.leave[axis] += grown;
  }
}

}  // namespace

void visit(const WideBvh& bvh, const Ray& ray, float margin, void* visitor,
           float (*visit_leaf)(void* visitor, ChildLink leaf)) {
  if (!(ray.t_min <= ray.t_max)) return;
  WideRay wide;
  double scale = 1.0;
  if (HWY_UNLIKELY(!set_up(ray, bvh, wide))) {
    const PreparedRay prepared({.origin = ray.origin, .direction = ray.direction},
                               is_far(far_side(ray.origin, bvh.bounds), bvh));
    if (!prepared.valid()) return;
    if (!set_up<true>({.origin = prepared.origin, .direction = prepared.direction}, bvh, wide)) return;
    scale = prepared.scale;
  }
  const auto scaled = [scale](float t) {
    constexpr double largest = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(t * scale, -largest, largest));
  };
  // What is rounded to a subnormal number may have been a little more or less.
  constexpr float smallest = 0x1p-125f;
  const auto upper = [&](float t) { return std::abs(t) < smallest ? scaled(smallest) : scaled(t); };
  wide.t_min = std::abs(ray.t_min) < smallest ? scaled(-smallest) : scaled(ray.t_min);
  grow_boxes(wide, margin);
  const NodeConstants constants(wide);
  float limit = upper(ray.t_max);
  BoxVector t_best = box_vector(limit);
  Stack<2> stack;
  stack.link[0] = stack.bottom;
  std::size_t depth = 1;
  ChildLink link = ChildLink::node(0);
  while (true) {
    bool at_leaf = true;
    while (!link.is_leaf()) {
      const Node& node = node_at(bvh, link.node());
      const Spans spans = meet_boxes<false>(constants, t_best, node);
      step_next<false, false, false, 1>(bvh, constants, wide.octant, t_best, limit, stack, depth, nullptr);
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
      push_children<false>(node, spans, met, wide.octant, stack, depth, nearest);
      --depth;
      link = ChildLink(nearest);
    }
    if (at_leaf) {
      const float t_max = visit_leaf(visitor, link);
      if (t_max == -std::numeric_limits<float>::infinity()) return;
      limit = upper(t_max);
      t_best = box_vector(limit);
    }
    do {
      if (depth == 1) return;
      --depth;
    } while (stack.t[depth] > limit);
    link = ChildLink(stack.link[depth]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(visit);

void visit_leaves(Target target, const WideBvh& bvh, const Ray& ray, float margin, void* visitor,
                  float (*visit_leaf)(void* visitor, ChildLink leaf)) {
  KERF_DISPATCH(visit, target)(bvh, ray, margin, visitor, visit_leaf);
}

}  // namespace kerf
#endif
