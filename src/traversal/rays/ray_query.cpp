#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "math/ray_box.hpp"
#include "math/ray_triangle.hpp"
#include "simd/dispatch.hpp"
#include "simd/targets.hpp"
#include "traversal/dispatch.hpp"
#include "traversal/rays/prepared_ray.hpp"
#include "tree/binary_tree.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/rays/ray_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/floats-inl.h"
#include "traversal/query_kernels-inl.h"
#include "traversal/rays/interleaved-inl.h"
#include "traversal/rays/leaf_test-inl.h"
#include "traversal/rays/node_step-inl.h"
#include "traversal/rays/packet-inl.h"
#include "traversal/rays/wide_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Rays by turns hide the waiting for memory. A hierarchy of up to this many bytes is near enough to the core
// for rays one after another, which take several nodes at a time (docs/decisions/0054).
[[maybe_unused]] constexpr std::size_t single_bytes = std::size_t{5} << 20;

// After packets that fell apart one after another, twice as many each time are traced by turns before the
// next try.
[[maybe_unused]] constexpr std::uint32_t most_packets_let_pass = 32;

// A step is mostly waiting for the one before it. Where nodes come next on the stack their steps are taken in
// its shadow, though a hit below the nearer ones might have spared them: some more steps in less time.
constexpr std::size_t nodes_a_step = 3;

// Takes up to `most` nodes off the stack, for which their children come.
template <bool any_hit, bool counting, std::size_t most, class Stack>
HWY_INLINE void step_next(const WideBvh& bvh, const NodeConstants& constants, std::uint32_t octant,
                          BoxVector t_best, float best_t, Stack& stack, std::size_t& depth,
                          TraversalCounters* counters) {
  if constexpr (most > 0) {
    const ChildLink next(stack.link[depth - 1]);
    if (next.is_leaf() | (!any_hit && stack.t[depth - 1] > best_t)) return;
    --depth;
    if constexpr (counting) ++counters->steps;
    const WideNode& node = bvh.nodes[next.node()];
    const Spans spans = meet_boxes(constants, t_best, node);
    step_next<any_hit, counting, most - 1>(bvh, constants, octant, t_best, best_t, stack, depth, counters);
    std::uint32_t nearest;
    push_children<any_hit>(node, spans, octant, stack, depth, nearest);
  }
}

// A ray that `set_up` took, from the root on.
template <bool any_hit, bool counting>
HWY_INLINE Hit trace(const WideBvh& bvh, const Ray& caller_ray, const WideRay& ray,
                     TraversalCounters* counters) {
  Hit best;
  if (!(caller_ray.t_min <= caller_ray.t_max)) return best;
  best.t = std::min(caller_ray.t_max, std::numeric_limits<float>::max());
  const NodeConstants node_constants(ray);
  const LeafConstants leaf_constants(ray);
  BoxVector t_best = box_vector(best.t);
  Stack<nodes_a_step> stack;
  stack.link[0] = stack.bottom;
  std::size_t depth = 1;
  ChildLink link = ChildLink::node(0);
  while (true) {
    bool at_leaf = true;
    while (!link.is_leaf()) {
      if constexpr (counting) ++counters->steps;
      const WideNode& node = bvh.nodes[link.node()];
      const Spans spans = meet_boxes(node_constants, t_best, node);
      step_next<any_hit, counting, nodes_a_step - 1>(bvh, node_constants, ray.octant, t_best, best.t, stack,
                                                     depth, counters);
      const std::uint32_t met = less_or_equal(spans.first, spans.last);
      if (met == 0) {
        at_leaf = false;
        break;
      }
      // Half of the steps meet one child alone. With a branch of its own it is known some ten cycles sooner,
      // which outweighs what the branch costs where it is mispredicted.
      if ((met & (met - 1)) == 0) {
        link = node.children[std::countr_zero(met)];
        continue;
      }
      std::uint32_t nearest;
      push_children<any_hit>(node, spans, ray.octant, stack, depth, nearest);
      --depth;
      link = ChildLink(nearest);
    }
    if (at_leaf) {
      if constexpr (counting) {
        ++counters->leaves;
        counters->triangle_tests += link.count();
      }
      if (intersect_leaf<any_hit>(leaf_constants, bvh, link, caller_ray, best)) {
        if constexpr (any_hit) return best;
        t_best = box_vector(best.t);
      }
    }
    do {
      if (depth == 1) return any_hit ? Hit{} : best;
      --depth;
    } while (!any_hit && stack.t[depth] > best.t);
    link = ChildLink(stack.link[depth]);
  }
}

// In one piece: whoever reads the hit next reads it in larger pieces than fields, and waits if it was written
// field by field.
HWY_INLINE void write(const Hit& from, Hit& to) {
#if KERF_FLOAT_LANES == 1
  to = from;
#else
  const FourTag tag;
  const hn::RebindToUnsigned<FourTag> integers;
  const Four tu = hn::InterleaveLower(hn::Set(tag, from.t), hn::Set(tag, from.u));
  const Four vp =
      hn::InterleaveLower(hn::Set(tag, from.v), hn::BitCast(tag, hn::Set(integers, from.primitive)));
  hn::StoreU(hn::ConcatLowerLower(tag, vp, tu), tag, &to.t);
  to.mesh = invalid_id;
#endif
}

template <bool any_hit, bool counting>
HWY_NOINLINE HWY_ATTR Hit trace_prepared(const WideBvh& bvh, const Ray& ray, TraversalCounters* counters) {
  const PreparedRay prepared(ray);
  if (!prepared.valid()) return Hit{};
  const Ray tame{.origin = prepared.origin,
                 .direction = prepared.direction,
                 .t_min = prepared.t_min,
                 .t_max = prepared.t_max};
  WideRay wide;
  if (!set_up(tame, bvh, wide)) return Hit{};
  Hit hit = trace<any_hit, counting>(bvh, tame, wide, counters);
  hit.t = prepared.unscaled(hit.t);
  return hit;
}

template <bool any_hit, bool counting>
HWY_INLINE Hit trace_any_ray(const WideBvh& bvh, const Ray& ray, TraversalCounters* counters) {
  WideRay wide;
  if (HWY_UNLIKELY(!set_up(ray, bvh, wide))) return trace_prepared<any_hit, counting>(bvh, ray, counters);
  return trace<any_hit, counting>(bvh, ray, wide, counters);
}

HWY_ATTR void closest(const WideBvh& bvh, const Ray& ray, Hit& hit) {
  write(trace_any_ray<false, false>(bvh, ray, nullptr), hit);
}
HWY_ATTR bool any(const WideBvh& bvh, const Ray& ray) {
  return static_cast<bool>(trace_any_ray<true, false>(bvh, ray, nullptr));
}
HWY_ATTR Hit closest_counted(const WideBvh& bvh, const Ray& ray, TraversalCounters& counters) {
  return trace_any_ray<false, true>(bvh, ray, &counters);
}
HWY_ATTR bool any_counted(const WideBvh& bvh, const Ray& ray, TraversalCounters& counters) {
  return static_cast<bool>(trace_any_ray<true, true>(bvh, ray, &counters));
}

#if KERF_PACKETS
// Packets where rays keep together; the others, all at once, by turns. `finish(i, hit)` is called once for
// each ray.
template <bool any_hit, class Finish>
HWY_INLINE void trace_part(const WideBvh& bvh, const Ray* rays, std::uint32_t count, Finish&& finish) {
  Packet<any_hit> packet(bvh);
  std::uint32_t apart[rays_a_part], left = 0;
  std::uint32_t pass = 0, passes = 1;  // packets to let pass now, and when the next one falls apart
  std::uint32_t i = 0;
  for (; i + packet.width <= count; i += packet.width) {
    if (pass == 0 && packet.set(rays + i)) {
      packet.run([&](std::size_t lane, const Hit& hit) HWY_ATTR { finish(i + lane, hit); });
      if (packet.kept_together()) {
        passes = 1;
      } else {
        pass = passes;
        passes = std::min(2 * passes, most_packets_let_pass);
      }
    } else {
      for (std::uint32_t lane = 0; lane < packet.width; ++lane) apart[left++] = i + lane;
      pass -= pass > 0;
    }
  }
  for (; i < count; ++i) apart[left++] = i;
  if (left == 0) return;
  if (bvh.nodes.size_bytes() + bvh.leaves.size_bytes() <= single_bytes) {
    for (std::uint32_t k = 0; k < left; ++k)
      finish(apart[k], trace_any_ray<any_hit, false>(bvh, rays[apart[k]], nullptr));
    return;
  }
  Interleaved<any_hit> interleaved(bvh, rays, apart, left);
  interleaved.run(finish,
                  [&](const Ray& ray) HWY_ATTR { return trace_any_ray<any_hit, false>(bvh, ray, nullptr); });
}

template <bool any_hit, class Finish>
HWY_INLINE void trace_many(const WideBvh& bvh, const Ray* rays, std::size_t count, Finish&& finish) {
  for (std::size_t begin = 0; begin < count; begin += rays_a_part) {
    trace_part<any_hit>(bvh, rays + begin, static_cast<std::uint32_t>(std::min(rays_a_part, count - begin)),
                        [&](std::size_t i, const Hit& hit) HWY_ATTR { finish(begin + i, hit); });
  }
}

HWY_ATTR void closest_many(const WideBvh& bvh, const Ray* rays, std::size_t count, Hit* hits) {
  trace_many<false>(bvh, rays, count, [hits](std::size_t i, const Hit& hit) HWY_ATTR { hits[i] = hit; });
}
HWY_ATTR void any_many(const WideBvh& bvh, const Ray* rays, std::size_t count, std::uint8_t* occluded) {
  trace_many<true>(bvh, rays, count, [occluded](std::size_t i, const Hit& hit) HWY_ATTR {
    occluded[i] = static_cast<bool>(hit);
  });
}
#else
HWY_ATTR void closest_many(const WideBvh& bvh, const Ray* rays, std::size_t count, Hit* hits) {
  for (std::size_t i = 0; i < count; ++i) closest(bvh, rays[i], hits[i]);
}
HWY_ATTR void any_many(const WideBvh& bvh, const Ray* rays, std::size_t count, std::uint8_t* occluded) {
  for (std::size_t i = 0; i < count; ++i) occluded[i] = any(bvh, rays[i]);
}
#endif

// The same node, the same leaf, again and again, with everything in the first-level cache. What is returned
// depends on all of it, so that nothing can be left out.
HWY_ATTR std::uint64_t repeat_node_steps(const WideBvh& bvh, const Ray& caller_ray, std::size_t count) {
  WideRay ray;
  if (!set_up(caller_ray, bvh, ray)) return 0;
  const NodeConstants constants(ray);
  const BoxVector t_best = box_vector(std::min(caller_ray.t_max, std::numeric_limits<float>::max()));
  Stack<1> stack;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t depth = 1;
    std::uint32_t nearest = 0;
    __asm__ volatile("" ::: "memory");  // the node may have changed: read it again
    push_children<false>(bvh.nodes[0], meet_boxes(constants, t_best, bvh.nodes[0]), ray.octant, stack, depth,
                         nearest);
    sum += nearest;
  }
  return sum;
}
HWY_ATTR std::uint64_t repeat_leaf_tests(const WideBvh& bvh, const Ray& caller_ray, ChildLink leaf,
                                         std::size_t count) {
  WideRay ray;
  if (!set_up(caller_ray, bvh, ray)) return 0;
  const LeafConstants constants(ray);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Hit best;
    best.t = std::min(caller_ray.t_max, std::numeric_limits<float>::max());
    __asm__ volatile("" ::: "memory");
    sum += intersect_leaf<false>(constants, bvh, leaf, caller_ray, best);
  }
  return sum;
}

}  // namespace

const Kernels* kernels() {
  static const Kernels table{.target = hwy::TargetName(HWY_TARGET),
                             .closest = closest,
                             .any = any,
                             .closest_counted = closest_counted,
                             .any_counted = any_counted,
                             .closest_many = closest_many,
                             .any_many = any_many,
                             .closest_triangle = closest_triangle,
                             .triangles_within = triangles_within,
                             .visit_box = visit_box,
                             .line_meets = line_meets,
                             .line_may_cross = line_may_cross,
                             .repeat_node_steps = repeat_node_steps,
                             .repeat_leaf_tests = repeat_leaf_tests};
  return &table;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(kernels);

const Kernels& choose_kernels() {
  return *KERF_DISPATCH(kernels, choose_target())();
}

}  // namespace kerf
#endif
