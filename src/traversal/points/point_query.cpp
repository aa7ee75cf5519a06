#include <algorithm>
#include <bit>
#include <vector>

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

#include "traversal/points/point_boxes-inl.h"
#include "traversal/points/point_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Visits the nearest child first, until no box that is left is as near as the best triangle.
template <class Boxes>
HWY_INLINE bool find_closest(const WideBvh& bvh, const Vec3f& point, double reach, NearTriangle& best) {
  // A node some of whose children have not been visited.
  struct Open {
    const Node* node;
    Keys keys;
  };
  const Boxes boxes(point, bvh);
  const PointTriangles triangles(point);
  Open waiting[max_tree_depth];
  std::size_t depth = 0;
  bool any = false;
  std::uint32_t limit = boxes.limit(reach);
  Open open{&node_at(bvh, 0), boxes.keys(node_at(bvh, 0))};
  while (true) {
    const std::uint32_t key = min_key(open.keys);
    if (key > limit) {
      if (depth == 0) return any;
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
    triangles.find(bvh, child, reach, [&](const NearTriangle& found) HWY_ATTR {
      if (any && !is_nearer(found, best)) return;
      any = true;
      best = found;
      reach = found.squared_distance;
      limit = boxes.limit(reach);
    });
  }
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
void triangles_within(const WideBvh& bvh, const Vec3f& point, double reach,
                      std::vector<NearTriangle>& found) {
  is_far(bvh, point) ? find_within<FarPointBoxes>(bvh, point, reach, found)
                     : find_within<PointBoxes>(bvh, point, reach, found);
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();
