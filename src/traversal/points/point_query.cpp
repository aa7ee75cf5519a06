#include <algorithm>
#include <bit>
#include <vector>

#include "base/id_set.hpp"
#include "math/point_box.hpp"
#include "math/predicates.hpp"
#include "simd/targets.hpp"
#include "traversal/dispatch.hpp"
#include "traversal/points/near_triangle.hpp"
#include "tree/binary_tree.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/points/point_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "traversal/points/point_boxes-inl.h"
#include "traversal/points/point_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Visits the nearest child first, until no box that is left is as near as `reach`. `found(triangle)` is
// called for each triangle of a leaf within `reach`, and gives what `reach` is from then on.
template <class Boxes, class Found>
HWY_INLINE void visit_nearest_first(const WideBvh& bvh, const Vec3f& point, double reach, Found&& found) {
  // A node some of whose children have not been visited.
  struct Open {
    const Node* node;
    Keys keys;
  };
  const Boxes boxes(point, bvh);
  const PointTriangles triangles(point);
  Open waiting[max_tree_depth];
  std::size_t depth = 0;
  std::uint32_t limit = boxes.limit(reach);
  Open open{&node_at(bvh, 0), boxes.keys(node_at(bvh, 0))};
  while (true) {
    const std::uint32_t key = min_key(open.keys);
    if (key > limit) {
      if (depth == 0) return;
      open = waiting[--depth];
      continue;
    }
    open.keys = without(open.keys, key);
    const ChildLink child = open.node->children[key & Keys::slot_bits];
    if (!child.is_leaf()) {
      waiting[depth++] = open;
      open.node = &node_at(bvh, child.node());
      open.keys = boxes.keys(*open.node);
      continue;
    }
    triangles.find(bvh, child, reach, [&](const NearTriangle& triangle) HWY_ATTR {
      const double next = found(triangle);
      if (next == reach) return;
      reach = next;
      limit = boxes.limit(reach);
    });
  }
}

template <class Boxes>
HWY_INLINE bool find_closest(const WideBvh& bvh, const Vec3f& point, double reach, NearTriangle& best) {
  bool any = false;
  visit_nearest_first<Boxes>(bvh, point, reach, [&](const NearTriangle& triangle) HWY_ATTR {
    if (!any || is_nearer(triangle, best)) best = triangle;
    any = true;
    return best.squared_distance;
  });
  return any;
}

// A triangle that has left the heap is never among the nearest again, so that the set need not forget it.
template <class Boxes>
HWY_INLINE void find_nearest(const WideBvh& bvh, const Vec3f& point, double reach, std::size_t count,
                             std::vector<NearTriangle>& nearest) {
  IdSet ids;
  visit_nearest_first<Boxes>(bvh, point, reach, [&](const NearTriangle& triangle) {
    const bool full = nearest.size() == count;
    if ((!full || is_nearer(triangle, nearest.front())) && ids.insert(triangle.id)) {
      if (full) {
        std::pop_heap(nearest.begin(), nearest.end(), is_nearer);
        nearest.pop_back();
      }
      nearest.push_back(triangle);
      std::push_heap(nearest.begin(), nearest.end(), is_nearer);
    }
    return nearest.size() == count ? nearest.front().squared_distance : reach;
  });
}

template <class Boxes>
HWY_INLINE void find_within(const WideBvh& bvh, const Vec3f& point, double reach,
                            std::vector<NearTriangle>& found) {
  const Boxes boxes(point, bvh);
  const PointTriangles triangles(point);
  const std::uint32_t limit = boxes.limit(reach);
  ChildLink waiting[node_width * max_tree_depth];
  std::size_t depth = 0;
  waiting[depth++] = ChildLink::node(0);
  while (depth != 0) {
    const ChildLink link = waiting[--depth];
    if (link.is_leaf()) {
      triangles.find(bvh, link, reach, [&](const NearTriangle& triangle) { found.push_back(triangle); });
    } else {
      const Node& node = node_at(bvh, link.node());
      for (std::uint32_t rest = not_above(boxes.keys(node), limit); rest != 0; rest &= rest - 1)
        waiting[depth++] = node.children[std::countr_zero(rest)];
    }
  }
}

// Whether the scene is too far from `point` for `PointBoxes`.
bool is_far(const WideBvh& bvh, const Vec3f& point) {
  const Vec3d extents = difference(bvh.bounds.upper, bvh.bounds.lower);
  const double limit = PointBoxes::max_extents * std::max({extents.x, extents.y, extents.z});
  return squared_distance(point, bvh.bounds) > limit * limit;
}

}  // namespace

bool closest_triangle(const WideBvh& bvh, const Vec3f& point, double reach, NearTriangle& best) {
  return is_far(bvh, point) ? find_closest<FarPointBoxes>(bvh, point, reach, best)
                            : find_closest<PointBoxes>(bvh, point, reach, best);
}
void nearest_triangles(const WideBvh& bvh, const Vec3f& point, double reach, std::size_t count,
                       std::vector<NearTriangle>& nearest) {
  is_far(bvh, point) ? find_nearest<FarPointBoxes>(bvh, point, reach, count, nearest)
                     : find_nearest<PointBoxes>(bvh, point, reach, count, nearest);
}
void triangles_within(const WideBvh& bvh, const Vec3f& point, double reach,
                      std::vector<NearTriangle>& found) {
  is_far(bvh, point) ? find_within<FarPointBoxes>(bvh, point, reach, found)
                     : find_within<PointBoxes>(bvh, point, reach, found);
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

KERF_EXPORT_KERNEL(closest_triangle);
KERF_EXPORT_KERNEL(nearest_triangles);
KERF_EXPORT_KERNEL(triangles_within);

}  // namespace kerf
#endif
