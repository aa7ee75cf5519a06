#include "kernel/binary_traversal.hpp"

#include <array>

#include "kernel/prepared_ray.hpp"
#include "math/ray_box.hpp"
#include "math/ray_triangle.hpp"

namespace kerf {
namespace {

template <bool any_hit, bool counting>
Hit trace(const Bvh::Structure& structure, const Ray& caller_ray, TraversalCounters* counters) {
  Hit best;
  const PreparedRay ray(caller_ray);
  if (structure.tree.empty() || !ray.valid()) return best;
  const std::vector<BinaryNode>& nodes = structure.tree.nodes;
  const RayBoxes boxes(ray.origin, ray.direction, nodes[0].bounds);
  const RayShear shear(ray.direction);
  best.t = ray.t_max;
  struct Entry {
    std::uint32_t node;
    float t;
  };
  std::array<Entry, max_tree_depth + 1> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, boxes.entry(nodes[0].bounds, ray.t_min, ray.t_max)};
  while (depth > 0) {
    Entry entry = stack[--depth];
    if (!(entry.t <= best.t)) continue;  // what lies at best.t may be a lower primitive
    while (!nodes[entry.node].is_leaf()) {
      if constexpr (counting) ++counters->steps;
      const BinaryNode& node = nodes[entry.node];
      Entry near{node.left(), boxes.entry(nodes[node.left()].bounds, ray.t_min, best.t)};
      Entry far{node.right(), boxes.entry(nodes[node.right()].bounds, ray.t_min, best.t)};
      if (far.t < near.t) std::swap(near, far);
      if (far.t <= best.t) stack[depth++] = far;
      entry = near;
      if (!(near.t <= best.t)) break;
    }
    if (!(entry.t <= best.t)) continue;
    const BinaryNode& leaf = nodes[entry.node];
    if constexpr (counting) ++counters->leaves;
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      if constexpr (counting) ++counters->triangle_tests;
      Hit hit;
      if (!intersect_triangle(shear, ray.origin, structure.triangles[i], ray.t_min, best.t, hit)) continue;
      hit.primitive = structure.tree.references[i];
      if (hit.t < best.t || hit.primitive < best.primitive) best = hit;
      if (any_hit) return best;
    }
  }
  best.t = ray.unscaled(best.t);
  return best;
}

}  // namespace

Hit trace_closest(const Bvh::Structure& structure, const Ray& ray, TraversalCounters* counters) {
  return counters ? trace<false, true>(structure, ray, counters)
                  : trace<false, false>(structure, ray, nullptr);
}

bool trace_any(const Bvh::Structure& structure, const Ray& ray, TraversalCounters* counters) {
  return static_cast<bool>(counters ? trace<true, true>(structure, ray, counters)
                                    : trace<true, false>(structure, ray, nullptr));
}

}  // namespace kerf
