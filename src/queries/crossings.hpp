// Every crossing of a ray, in order, from one traversal.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>

#include <kerf/ray.hpp>

#include "base/out_of_memory.hpp"
#include "math/ray_crossing.hpp"
#include "math/vec3f.hpp"
#include "queries/line_crossing.hpp"
#include "queries/small_vector.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {

/// Calls `visit(id, hit)` for each triangle that the ray crosses in `[t_min, t_max]`, once, in the order of
/// (t, id), until `visit` returns false. `hit` has t, u and v. Throws `Error::out_of_memory`, and what
/// `visit` throws as it is.
///
/// Nodes and crossings wait in one queue, nearest first. A crossing is visited when no node that is left to
/// open can contain an earlier one. A triangle with references in several leaves is found in each of them
/// that the ray meets, always at the same t. Whether it has been visited already, its place in the order
/// tells: then it does not come after the last crossing visited.
template <class Visit>
void for_each_crossing(const Structure& structure, Ray ray, Visit&& visit) {
  struct Item {
    float t;
    std::uint32_t order;  // 0 for a node, else 1 + the triangle's number: at the same t nodes come first
    ChildLink link;
    float u, v;
  };
  const auto later = [](const Item& a, const Item& b) { return a.t != b.t ? a.t > b.t : a.order > b.order; };

  ray.t_min = std::max(ray.t_min, 0.0f);
  const bool valid =
      is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3f{} && ray.t_min <= ray.t_max;
  const WideBvh& bvh = structure.wide;
  if (bvh.empty() || !valid) return;

  SmallVector<Item, 8192> queue;  // a few levels of waiting nodes: most rays do without the heap
  const auto push = [&](const Item& item) {
    report_out_of_memory([&] { queue.push_back(item); });
    std::push_heap(queue.begin(), queue.end(), later);
  };

  const PreparedLine line(ray);
  push({ray.t_min, 0, ChildLink::node(0), 0.0f, 0.0f});
  Item last{-1.0f, 0, {}, 0.0f, 0.0f};
  while (!queue.empty()) {
    std::pop_heap(queue.begin(), queue.end(), later);
    const Item item = queue.back();
    queue.pop_back();
    if (item.order != 0) {
      if (!later(item, last)) continue;
      last = item;
      if (!visit(item.order - 1, Hit{item.t, item.u, item.v})) return;
    } else if (item.link.is_leaf()) {
      for (std::uint32_t rest = structure.kernels->line_may_cross(bvh, item.link, line); rest != 0;
           rest &= rest - 1) {
        const auto place = static_cast<std::uint32_t>(std::countr_zero(rest));
        const Triangle triangle = triangle_in(bvh, item.link, place);
        if (!line_crosses(ray.origin, ray.direction, triangle)) continue;
        const RayCrossing crossing = crossing_of(ray.origin, ray.direction, triangle);
        if (!(crossing.t >= ray.t_min && crossing.t <= ray.t_max)) continue;
        const Item found{crossing.t, 1 + triangle_id(bvh, item.link, place), {}, crossing.u, crossing.v};
        if (later(found, last)) push(found);
      }
    } else {
      float entry[max_node_width];
      ChildLink children[max_node_width];
      for (std::uint32_t rest = structure.kernels->line_meets(bvh, item.link.node(), line, entry, children);
           rest != 0; rest &= rest - 1) {
        const int slot = std::countr_zero(rest);
        push({entry[slot], 0, children[slot], 0.0f, 0.0f});
      }
    }
  }
}

}  // namespace kerf
