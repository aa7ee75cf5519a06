// Every crossing of a ray: counted, listed, in order, and by their parity.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "base/id_set.hpp"
#include "base/out_of_memory.hpp"
#include "layout/wide_bvh.hpp"
#include "math/box3f.hpp"
#include "math/line_crossing.hpp"
#include "simd/targets.hpp"
#include "traversal/dispatch.hpp"
#include "traversal/lines/crossing.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/lines/line_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "traversal/lines/line_leaf-inl.h"
#include "traversal/lines/line_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Out of line, as what few triangles need, and with nothing by reference that is in registers otherwise.
HWY_NOINLINE HWY_ATTR bool crosses_exactly(const WideBvh& bvh, ChildLink leaf, std::uint32_t i,
                                           const Ray& ray) {
  RayCrossing crossing;
  return ray_crosses(ray, triangle_in(bvh, leaf, i), crossing);
}

// Calls `found(i)` for each triangle of the leaf that is crossed.
template <class Found>
HWY_INLINE void for_each_crossed(const WideBvh& bvh, ChildLink leaf, const Ray& ray,
                                 const LeafCrossings& crossings, Found&& found) {
  std::uint32_t crossed = crossings.certain;
  for (std::uint32_t rest = crossings.open; HWY_UNLIKELY(rest != 0); rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
    crossed |= std::uint32_t{crosses_exactly(bvh, leaf, i, ray)} << i;
  }
  for (; crossed != 0; crossed &= crossed - 1) found(static_cast<std::uint32_t>(std::countr_zero(crossed)));
}

// Calls `found(crossing)` for each triangle of the leaf that is crossed.
template <class Found>
HWY_INLINE void for_each_crossing(const WideBvh& bvh, ChildLink leaf, const Ray& ray,
                                  const LeafCrossings& crossings, Found&& found) {
  for (std::uint32_t rest = crossings.certain | crossings.open; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
    const Triangle triangle = triangle_in(bvh, leaf, i);
    RayCrossing at;
    if (HWY_LIKELY((crossings.certain >> i) & 1)) {
      at = crossing_of(ray.origin, ray.direction, triangle);
    } else if (!ray_crosses(ray, triangle, at)) {
      continue;
    }
    found(Crossing{at.t, at.u, at.v, triangle_id(bvh, leaf, i)});
  }
}

// The direction of the ray whose crossings are counted for a point. Any gives the same answer. One that is
// oblique to all coordinate planes leaves few decisions to exact arithmetic in scenes with walls along the
// axes.
constexpr Vec3f oblique{0.8571f, 0.3163f, 0.4067f};

// The nodes that wait, with the distances at which the ray enters them. The last is the next. One below it
// that is nearer comes first as long as there are few: then there is room for all that come after.
using WaitingNodes = Stack<2>;
constexpr std::size_t few_nodes = WaitingNodes::capacity - (node_width - 1) * max_tree_depth - 2 * node_width;

// Where the smallest of `count` numbers stands. A vector may be read behind the last.
HWY_INLINE std::size_t place_of_min(const float* t, std::size_t count) {
  const FloatTag tag;
  const auto infinity = hn::Set(tag, std::numeric_limits<float>::infinity());
  auto smallest = infinity;
  for (std::size_t i = 0; i < count; i += vector_lanes) {
    smallest = hn::Min(smallest, hn::IfThenElse(hn::FirstN(tag, count - i), hn::LoadU(tag, t + i), infinity));
  }
  const float min = hn::GetLane(hn::MinOfLanes(tag, smallest));
  std::size_t place = 0;
  while (t[place] != min) ++place;
  return place;
}

}  // namespace

std::size_t count_crossings(const WideBvh& bvh, const Ray& ray) {
  LineRay line;
  if (!set_up_line(ray, bvh, line)) return 0;
  IdSet ids;
  walk_line(bvh, line, [&](ChildLink leaf) HWY_ATTR {
    const LeafCrossings crossings = cross_leaf(line.leaf, bvh, leaf);
    if ((crossings.certain | crossings.open) == 0) return true;
    for_each_crossed(bvh, leaf, ray, crossings,
                     [&](std::uint32_t i) { ids.insert(triangle_id(bvh, leaf, i)); });
    return true;
  });
  return ids.size();
}

void find_crossings(const WideBvh& bvh, const Ray& ray, Crossings& found) {
  LineRay line;
  if (!set_up_line(ray, bvh, line)) return;
  walk_line(bvh, line, [&](ChildLink leaf) HWY_ATTR {
    for_each_crossing(bvh, leaf, ray, cross_leaf(line.leaf, bvh, leaf),
                      [&](const Crossing& crossing) { found.push_back(crossing); });
    return true;
  });
}

// Nodes wait on a stack, the nearest children on top, and crossings in a heap. A crossing is visited when no
// node that waits can contain an earlier one. A triangle with references in several leaves is found in each
// of them that the ray meets, always at the same t. Whether it has been visited already, its place in the
// order tells: then it does not come after the last crossing visited.
void visit_crossings(const WideBvh& bvh, const Ray& ray, void* visitor,
                     bool (*visit)(void* visitor, const Crossing& crossing)) {
  LineRay line;
  if (!set_up_line(ray, bvh, line)) return;
  const auto later = [](const Crossing& a, const Crossing& b) { return comes_before(b, a); };
  Crossings found;
  Crossing last{-std::numeric_limits<float>::infinity(), 0.0f, 0.0f, 0};
  bool any = false;
  const auto report = [&](const Crossing& crossing) {
    if (any && !comes_before(last, crossing)) return true;
    any = true;
    last = crossing;
    return visit(visitor, crossing);
  };

  const NodeConstants constants(line.wide);
  const BoxVector t_max = box_vector(line.t_max);
  WaitingNodes waiting;
  const auto entered = [&](std::size_t i) {
    return static_cast<float>(
        std::min(waiting.t[i] * line.unscale, double{std::numeric_limits<float>::max()}));
  };
  std::size_t depth = 0;
  ChildLink link = ChildLink::node(0);
  while (true) {
    if (link.is_leaf()) {
      for_each_crossing(bvh, link, ray, cross_leaf(line.leaf, bvh, link), [&](const Crossing& crossing) {
        if (any && !comes_before(last, crossing)) return;
        report_out_of_memory([&] { found.push_back(crossing); });
        std::push_heap(found.begin(), found.end(), later);
      });
    } else {
      const Node& node = node_at(bvh, link.node());
      std::uint32_t nearest;
      const Spans spans = meet_boxes<false>(constants, t_max, node);
      push_children<false>(node, spans, boxes_met<false>(spans), line.wide.octant, waiting, depth, nearest);
    }
    while (true) {
      if (depth == 0) {
        report_out_of_memory([&] { sort_crossings({found.begin(), found.size()}); });
        for (const Crossing& crossing : found)
          if (!report(crossing)) return;
        return;
      }
      if (found.empty() || depth > few_nodes || entered(depth - 1) <= found.front().t) break;
      const std::size_t place = place_of_min(waiting.t, depth);
      const float nearest = entered(place);
      if (nearest <= found.front().t) {
        std::swap(waiting.t[place], waiting.t[depth - 1]);
        std::swap(waiting.link[place], waiting.link[depth - 1]);
        break;
      }
      do {
        std::pop_heap(found.begin(), found.end(), later);
        const Crossing crossing = found.back();
        found.pop_back();
        if (!report(crossing)) return;
      } while (!found.empty() && found.front().t < nearest);
    }
    link = ChildLink(waiting.link[--depth]);
  }
}

// One ray from the point: its leaves are among those whose boxes hold the point, so that it also meets the
// triangles that the point lies on. They are not certainly missed, nor at a t that is certainly not 0.
Side side_of(const WideBvh& bvh, const Vec3f& point) {
  const Ray ray{.origin = point, .direction = oblique};
  LineRay line;
  if (!set_up_line(ray, bvh, line)) return Side::outside;
  IdSet ids;
  bool on = false;
  walk_line(bvh, line, [&](ChildLink leaf) HWY_ATTR {
    const LeafCrossings crossings = cross_leaf(line.leaf, bvh, leaf);
    for (std::uint32_t rest = crossings.open; HWY_UNLIKELY(rest != 0); rest &= rest - 1) {
      const Triangle triangle = triangle_in(bvh, leaf, static_cast<std::uint32_t>(std::countr_zero(rest)));
      if (!contains(bounds_of(triangle), Box3f{point, point}) || !lies_on(point, triangle)) continue;
      on = true;
      return false;
    }
    for_each_crossed(bvh, leaf, ray, crossings,
                     [&](std::uint32_t i) { ids.insert(triangle_id(bvh, leaf, i)); });
    return true;
  });
  if (on) return Side::on;
  return ids.size() % 2 == 1 ? Side::inside : Side::outside;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

KERF_EXPORT_KERNEL(count_crossings);
KERF_EXPORT_KERNEL(find_crossings);
KERF_EXPORT_KERNEL(visit_crossings);
KERF_EXPORT_KERNEL(side_of);

}  // namespace kerf
#endif
