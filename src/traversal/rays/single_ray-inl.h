// One ray from the root to its hit.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_SINGLE_RAY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_SINGLE_RAY_INL_H
#undef KERF_TRAVERSAL_RAYS_SINGLE_RAY_INL_H
#else
#define KERF_TRAVERSAL_RAYS_SINGLE_RAY_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <hwy/highway.h>
#include <kerf/counters.hpp>

#include "traversal/rays/leaf_test-inl.h"
#include "traversal/rays/node_step-inl.h"
#include "traversal/rays/prepared_ray.hpp"
#include "traversal/rays/wide_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// A node step mostly waits for the one before it. Where several nodes lie on top of the stack, their steps
// are taken while it waits, although a hit below the nearer ones might have culled them: a few more steps in
// less time (docs/decisions/0051, 0085, 0109).
constexpr std::size_t nodes_per_step = KERF_FLOAT_LANES == 8 ? 2 : 3;

// Traces a ray that `set_up` took, from the root on. `forward`: see `meet_boxes`.
template <bool any_hit, bool counting, bool forward, class Filter>
HWY_INLINE Hit trace(const WideBvh& bvh, const Ray& caller_ray, WideRay& ray, const Filter& filter,
                     TraversalCounters* counters) {
  if (!(caller_ray.t_min <= caller_ray.t_max)) return Hit{};
  Nearest best(std::min(caller_ray.t_max, std::numeric_limits<float>::max()));
  BoxVector t_best = box_vector(best.last);
  Stack<nodes_per_step> stack;
  stack.link[0] = stack.bottom;
  std::size_t depth = 1;
  ChildLink link = ChildLink::node(0);
  while (true) {
    bool at_leaf = true;
    // The ray's constants come from memory, each by a broadcast, whenever its nodes and its leaves take
    // turns: registers do not hold both. Compilers, left alone, prepare all of them first, store them and
    // load them.
    __asm__ volatile("" : "+m"(ray));
    const NodeConstants node_constants(ray);
    while (!link.is_leaf()) {
      if constexpr (counting) ++counters->steps;
      const Node& node = node_at(bvh, link.node());
      const Spans spans = meet_boxes<forward>(node_constants, t_best, node);
      step_next<any_hit, counting, forward, nodes_per_step - 1>(bvh, node_constants, ray.octant, t_best,
                                                                best.last, stack, depth, counters);
      const std::uint32_t met = boxes_met<forward>(spans);
      if (met == 0) {
        at_leaf = false;
        break;
      }
      // Half of the steps meet one child only. With a branch of its own that child is known some ten cycles
      // sooner, which outweighs mispredictions of the branch.
      if ((met & (met - 1)) == 0) {
        link = node.children[std::countr_zero(met)];
        continue;
      }
      std::uint32_t nearest;
      push_children<any_hit>(node, spans, met, ray.octant, stack, depth, nearest);
      --depth;
      link = ChildLink(nearest);
    }
    if (at_leaf) {
      if constexpr (counting) {
        ++counters->leaves;
        counters->triangle_tests += link.count();
      }
      __asm__ volatile("" : "+m"(ray));
      if (intersect_leaf<any_hit>(LeafConstants(ray), bvh, link, caller_ray, best, filter)) {
        if constexpr (any_hit) return Hit{.primitive = best.primitive};
        t_best = box_vector(best.last);
      }
    }
    do {
      if (depth == 1) return any_hit ? Hit{} : settled_hit(bvh, caller_ray, best);
      --depth;
    } while (!any_hit && stack.t[depth] > best.last);
    link = ChildLink(stack.link[depth]);
  }
}

// The same, compiled once for rays that take their time anyway: counted, filtered, or scaled before.
template <bool any_hit, bool counting, class Filter>
HWY_NOINLINE HWY_ATTR Hit trace_out_of_line(const WideBvh& bvh, const Ray& caller_ray, WideRay& ray,
                                            const Filter& filter, TraversalCounters* counters) {
  return trace<any_hit, counting, false>(bvh, caller_ray, ray, filter, counters);
}

// Traces a ray that has to be scaled before, or that begins behind its origin.
template <bool any_hit, bool counting, class Filter>
HWY_NOINLINE HWY_ATTR Hit trace_prepared(const WideBvh& bvh, const Ray& ray, Filter filter,
                                         TraversalCounters* counters) {
  const PreparedRay prepared(ray, is_far(far_side(ray.origin, bvh.bounds), bvh));
  if (!prepared.valid()) return Hit{};
  // The range that is traced holds every t which rounds into the caller's, and a few more.
  const bool is_wider = !Filter::filters && prepared.has_subnormal_end(ray);
  if constexpr (any_hit && !Filter::filters) {  // a hit that tells its t
    if (is_wider)
      return Hit{.primitive = trace_prepared<false, counting>(bvh, ray, filter, counters).primitive};
  }
  Ray scaled{.origin = prepared.origin,
             .direction = prepared.direction,
             .t_min = prepared.t_min,
             .t_max = prepared.t_max};
  WideRay wide;
  if constexpr (Filter::filters) {
    filter.prepared = &prepared;
    filter.caller = &ray;
  }
  while (scaled.t_min <= scaled.t_max && set_up<true>(scaled, bvh, wide)) {
    Hit hit = trace_out_of_line<any_hit, counting>(bvh, scaled, wide, filter, counters);
    if (!hit) return Hit{};
    const float t = prepared.unscaled(hit.t);
    if (is_wider && t > ray.t_max) return Hit{};
    if (!is_wider || t >= ray.t_min) {
      hit.t = t;
      return hit;
    }
    scaled.t_min = std::nextafter(hit.t, std::numeric_limits<float>::infinity());
  }
  return Hit{};
}

template <bool any_hit, bool counting, class Filter = NoFilter>
HWY_INLINE Hit trace_any_ray(const WideBvh& bvh, const Ray& ray, TraversalCounters* counters,
                             const Filter& filter = {}) {
  WideRay wide;
  if (HWY_UNLIKELY(!set_up_forward(ray, bvh, wide)))
    return trace_prepared<any_hit, counting>(bvh, ray, filter, counters);
  if constexpr (counting || Filter::filters)
    return trace_out_of_line<any_hit, counting>(bvh, ray, wide, filter, counters);
  return trace<any_hit, counting, true>(bvh, ray, wide, filter, counters);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
