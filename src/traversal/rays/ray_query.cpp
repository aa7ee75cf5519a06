// Rays: closest hit and any hit, one by one and many at once.
#include <algorithm>
#include <cstdint>
#include <limits>

#include <kerf/counters.hpp>

#include "layout/wide_bvh.hpp"
#include "simd/targets.hpp"
#include "traversal/dispatch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/rays/ray_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "traversal/rays/many_rays-inl.h"
#include "traversal/rays/single_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// With one 16-byte store, so that the caller's wide load forwards from the store buffer
// (docs/decisions/0048).
HWY_INLINE void write(const Hit& from, Hit& to) {
#if KERF_FLOAT_LANES == 1
  to = from;
#else
  const FloatTag4 tag;
  const hn::RebindToUnsigned<FloatTag4> integers;
  const Float4 tu = hn::InterleaveLower(hn::Set(tag, from.t), hn::Set(tag, from.u));
  const Float4 vp =
      hn::InterleaveLower(hn::Set(tag, from.v), hn::BitCast(tag, hn::Set(integers, from.primitive)));
  hn::StoreU(hn::ConcatLowerLower(tag, vp, tu), tag, &to.t);
  to.mesh = invalid_id;
#endif
}

}  // namespace

void closest(const WideBvh& bvh, const Ray& ray, Hit& hit) {
  write(trace_any_ray<false, false>(bvh, ray, nullptr), hit);
}
bool any(const WideBvh& bvh, const Ray& ray) {
  return static_cast<bool>(trace_any_ray<true, false>(bvh, ray, nullptr));
}
void closest_filtered(const WideBvh& bvh, const Ray& ray, void* context, bool (*accept)(void*, const Hit&),
                      Hit& hit) {
  write(trace_any_ray<false, false>(bvh, ray, nullptr, HitFilter{context, accept}), hit);
}
bool any_filtered(const WideBvh& bvh, const Ray& ray, void* context, bool (*accept)(void*, const Hit&)) {
  return static_cast<bool>(trace_any_ray<true, false>(bvh, ray, nullptr, HitFilter{context, accept}));
}
Hit closest_counted(const WideBvh& bvh, const Ray& ray, TraversalCounters& counters) {
  return trace_any_ray<false, true>(bvh, ray, &counters);
}
bool any_counted(const WideBvh& bvh, const Ray& ray, TraversalCounters& counters) {
  return static_cast<bool>(trace_any_ray<true, true>(bvh, ray, &counters));
}

#if KERF_PACKETS
void closest_many(const WideBvh& bvh, const Ray* rays, std::size_t count, Hit* hits) {
  trace_many<false>(bvh, rays, count, [hits](std::size_t i, const Hit& hit) HWY_ATTR { hits[i] = hit; });
}
void any_many(const WideBvh& bvh, const Ray* rays, std::size_t count, std::uint8_t* occluded) {
  trace_many<true>(bvh, rays, count, [occluded](std::size_t i, const Hit& hit) HWY_ATTR {
    occluded[i] = static_cast<bool>(hit);
  });
}
#else
void closest_many(const WideBvh& bvh, const Ray* rays, std::size_t count, Hit* hits) {
  for (std::size_t i = 0; i < count; ++i) closest(bvh, rays[i], hits[i]);
}
void any_many(const WideBvh& bvh, const Ray* rays, std::size_t count, std::uint8_t* occluded) {
  for (std::size_t i = 0; i < count; ++i) occluded[i] = any(bvh, rays[i]);
}
#endif

// The same node or leaf again and again, with everything in the first-level cache. The result depends on
// every visit, so that compilers cannot leave one out.
std::uint64_t repeat_node_steps(const WideBvh& bvh, const Ray& caller_ray, std::size_t count) {
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
    const Spans spans = meet_boxes<true>(constants, t_best, node_at(bvh, 0));
    push_children<false>(node_at(bvh, 0), spans, boxes_met<true>(spans), ray.octant, stack, depth, nearest);
    sum += nearest;
  }
  return sum;
}
std::uint64_t repeat_leaf_tests(const WideBvh& bvh, const Ray& caller_ray, ChildLink leaf,
                                std::size_t count) {
  WideRay ray;
  if (!set_up(caller_ray, bvh, ray)) return 0;
  const LeafConstants constants(ray);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Nearest best(std::min(caller_ray.t_max, std::numeric_limits<float>::max()));
    __asm__ volatile("" ::: "memory");
    sum += intersect_leaf<false>(constants, bvh, leaf, caller_ray, best);
  }
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

KERF_EXPORT_KERNEL(closest);
KERF_EXPORT_KERNEL(any);
KERF_EXPORT_KERNEL(closest_many);
KERF_EXPORT_KERNEL(any_many);
KERF_EXPORT_KERNEL(closest_filtered);
KERF_EXPORT_KERNEL(any_filtered);
KERF_EXPORT_KERNEL(closest_counted);
KERF_EXPORT_KERNEL(any_counted);
KERF_EXPORT_KERNEL(repeat_node_steps);
KERF_EXPORT_KERNEL(repeat_leaf_tests);

}  // namespace kerf
#endif
