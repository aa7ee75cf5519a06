#include "kernel/binary_traversal.hpp"

#include <array>
#include <vector>

#include "math/ray_triangle.hpp"

namespace kerf {
namespace {

// The slab test of Ize 2013 ("Robust BVH Ray Traversal"): the far distance is scaled up by twice the rounding error
// of the products, so that rounding never loses a box that the ray touches. A product 0 * inf is not a number, and
// the comparisons are written so that it leaves the interval as it was.
struct BoxTest {
  Vec3f origin, inverse;

  explicit BoxTest(const Ray& ray)
      : origin(ray.origin), inverse{1.0f / ray.direction.x, 1.0f / ray.direction.y, 1.0f / ray.direction.z} {}

  // Where the ray enters the box, or infinity if it misses.
  float entry(const Box3f& box, float t_min, float t_max) const {
    constexpr float widen = 1.0f + 4.0f * std::numeric_limits<float>::epsilon();
    float enter = t_min, leave = t_max;
    for (int axis = 0; axis < 3; ++axis) {
      float near = (box.lower[axis] - origin[axis]) * inverse[axis];
      float far = (box.upper[axis] - origin[axis]) * inverse[axis];
      if (inverse[axis] < 0.0f) std::swap(near, far);
      far *= widen;
      if (near > enter) enter = near;
      if (far < leave) leave = far;
    }
    return enter <= leave ? enter : std::numeric_limits<float>::infinity();
  }
};

template <bool any_hit>
Hit trace(const Bvh::Structure& structure, const Ray& ray, TraversalCounters& counters) {
  Hit best;
  if (structure.tree.empty() || !(ray.t_min <= ray.t_max)) return best;
  const BoxTest boxes(ray);
  const RayShear shear(ray.direction);
  best.t = ray.t_max;
  struct Entry {
    std::uint32_t node;
    float t;
  };
  std::vector<Entry> stack{{0, boxes.entry(structure.tree.nodes[0].bounds, ray.t_min, ray.t_max)}};
  while (!stack.empty()) {
    const auto [index, t] = stack.back();
    stack.pop_back();
    if (!(t <= best.t) || t == std::numeric_limits<float>::infinity()) continue;
    const BinaryNode& node = structure.tree.nodes[index];
    if (node.is_leaf()) {
      ++counters.leaves;
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        ++counters.triangle_tests;
        Hit hit;
        if (!intersect_triangle(shear, ray.origin, structure.triangles[i], ray.t_min, best.t, hit)) continue;
        hit.primitive = structure.tree.references[i];
        if (hit.t < best.t || hit.primitive < best.primitive) best = hit;
        if (any_hit) return best;
      }
      continue;
    }
    ++counters.steps;
    Entry near{node.left(), boxes.entry(structure.tree.nodes[node.left()].bounds, ray.t_min, best.t)};
    Entry far{node.right(), boxes.entry(structure.tree.nodes[node.right()].bounds, ray.t_min, best.t)};
    if (far.t < near.t) std::swap(near, far);
    stack.push_back(far);
    stack.push_back(near);
  }
  return best;
}

}  // namespace

Hit trace_closest(const Bvh::Structure& structure, const Ray& ray, TraversalCounters* counters) {
  TraversalCounters unused;
  return trace<false>(structure, ray, counters ? *counters : unused);
}

bool trace_any(const Bvh::Structure& structure, const Ray& ray, TraversalCounters* counters) {
  TraversalCounters unused;
  return static_cast<bool>(trace<true>(structure, ray, counters ? *counters : unused));
}

}  // namespace kerf
