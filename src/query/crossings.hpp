// Every crossing of a ray, in order, from one traversal.
#pragma once

#include <array>
#include <cstddef>
#include <memory_resource>
#include <vector>

#include <kerf/ray.hpp>

#include "math/vec3f.hpp"
#include "out_of_memory.hpp"
#include "query/line_crossing.hpp"
#include "query/line_slabs.hpp"
#include "query/tree_view.hpp"

namespace kerf {

/// Calls `visit(id, hit)` for each triangle that the ray crosses in `[t_min, t_max]`, once, in the order of
/// (t, id), until `visit` returns false. `hit` has t, u and v. Throws `Error::out_of_memory`, and what
/// `visit` throws as it is.
///
/// Nodes and crossings wait in one queue, nearest first; a crossing is visited when no node that is left to
/// open can hold an earlier one. A triangle with references in several leaves is found in each that the ray
/// meets, always at the same t: when it has been visited already, its place in the order is not behind that
/// of the last one visited.
template <class Visit>
void for_each_crossing(const TreeView& tree, Ray ray, Visit&& visit) {
  struct Item {
    float t;
    std::uint32_t order;  // 0: a node; else 1 + the triangle's number, so that at one t nodes come first
    TreeView::Node node;
    float u, v;
  };
  const auto later = [](const Item& a, const Item& b) { return a.t != b.t ? a.t > b.t : a.order > b.order; };

  ray.t_min = std::max(ray.t_min, 0.0f);
  const bool valid =
      is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3f{} && ray.t_min <= ray.t_max;
  if (tree.empty() || !valid) return;

  // Enough for most rays without the heap: a few levels of waiting nodes.
  std::array<std::byte, 8192> stack;
  std::pmr::monotonic_buffer_resource memory(stack.data(), stack.size());
  std::pmr::vector<Item> queue(&memory);
  queue.reserve(stack.size() / sizeof(Item) - 1);
  const auto push = [&](const Item& item) {
    report_out_of_memory([&] { queue.push_back(item); });
    std::push_heap(queue.begin(), queue.end(), later);
  };

  const auto rounded = [](double t) {
    return static_cast<float>(std::min(t, static_cast<double>(std::numeric_limits<float>::max()))) + 0.0f;
  };
  const LineSlabs slabs(ray);
  const auto push_node = [&](TreeView::Node node, const Box3f& box) {
    const double t = slabs.entry(box);
    if (t != std::numeric_limits<double>::infinity()) push({rounded(t), 0, node, 0.0f, 0.0f});
  };
  push_node(tree.root(), tree.bounds());
  Item last{-1.0f, 0, {}, 0.0f, 0.0f};
  while (!queue.empty()) {
    std::pop_heap(queue.begin(), queue.end(), later);
    const Item item = queue.back();
    queue.pop_back();
    if (item.order != 0) {
      if (!later(item, last)) continue;
      last = item;
      if (!visit(item.order - 1, Hit{item.t, item.u, item.v})) return;
    } else if (tree.is_leaf(item.node)) {
      tree.for_each_triangle(item.node, [&](std::uint32_t id, const Triangle& triangle) {
        const auto crossing = cross_line(ray.origin, ray.direction, triangle);
        if (!crossing || order_against(*crossing, ray.t_min, ray.origin, ray.direction, triangle) < 0 ||
            order_against(*crossing, ray.t_max, ray.origin, ray.direction, triangle) > 0) {
          return;
        }
        const Item found{rounded(crossing->t),
                         1 + id,
                         {},
                         static_cast<float>(crossing->u),
                         static_cast<float>(crossing->v)};
        if (later(found, last)) push(found);
      });
    } else {
      tree.for_each_child(item.node, push_node);
    }
  }
}

}  // namespace kerf
