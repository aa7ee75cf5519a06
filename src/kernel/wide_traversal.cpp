#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "kernel/kernels.hpp"
#include "kernel/prepared_ray.hpp"
#include "math/ray_box.hpp"
#include "math/ray_triangle.hpp"
#include "tree/binary_tree.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernel/wide_traversal.cpp"
#define HWY_DISABLED_TARGETS HWY_SSSE3  // such old machines take the scalar one
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernel/eight_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// What a node step needs of the ray.
struct NodeRay {
  Eight inverse[3], enter[3], leave[3], t_min;
  std::size_t near[3], far[3];  // where in a node the planes of entry and exit begin, in floats
  unsigned octant;

  HWY_ATTR NodeRay(const PreparedRay& ray, const Box3f& scene) {
    const RayBoxes boxes(ray.origin, ray.direction, scene);
    octant = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const bool negative = boxes.inverse[axis] < 0.0f;
      octant |= static_cast<unsigned>(negative) << axis;
      const std::size_t first = static_cast<std::size_t>(axis) * 2 * wide_node_children;
      near[axis] = first + (negative ? wide_node_children : 0);
      far[axis] = first + (negative ? 0 : wide_node_children);
      inverse[axis] = broadcast(boxes.inverse[axis]);
      enter[axis] = broadcast(boxes.enter[axis]);
      leave[axis] = broadcast(boxes.leave[axis]);
    }
    t_min = broadcast(ray.t_min);
  }
};

// What a leaf test needs of the ray.
struct LeafRay {
  Eight origin[3];  // along the shear's axes
  Eight sx, sy;
  float t_min;
  double inverse_dz;
  std::size_t axis[3];

  HWY_ATTR LeafRay(const PreparedRay& ray) : t_min(ray.t_min) {
    const RayShear shear(ray.direction);
    const int axes[3] = {shear.kx, shear.ky, shear.kz};
    for (int i = 0; i < 3; ++i) {
      axis[i] = static_cast<std::size_t>(axes[i]);
      origin[i] = broadcast(ray.origin[axes[i]]);
    }
    sx = broadcast(shear.sx);
    sy = broadcast(shear.sy);
    inverse_dz = shear.inverse_dz;
  }
};

struct Sheared {
  Eight x, y, z;
};

HWY_INLINE Sheared shear(const LeafRay& ray, const float* vertex_rows, std::size_t count) {
  const Eight z = load(vertex_rows + ray.axis[2] * count) - ray.origin[2];
  return {load(vertex_rows + ray.axis[0] * count) - ray.origin[0] - ray.sx * z,
          load(vertex_rows + ray.axis[1] * count) - ray.origin[1] - ray.sy * z, z};
}

// `intersect_triangle` on all triangles of a leaf at once, operation by operation. Returns whether `best`
// changed.
HWY_INLINE bool intersect_leaf(const LeafRay& ray, const std::uint32_t* words, std::uint32_t count,
                               Hit& best) {
  const float* rows = reinterpret_cast<const float*>(words);
  const Sheared a = shear(ray, rows, count), b = shear(ray, rows + 3 * count, count),
                c = shear(ray, rows + 6 * count, count);
  const Eight u = c.x * b.y - c.y * b.x, v = a.x * c.y - a.y * c.x, w = b.x * a.y - b.y * a.x;
  const Eight zero = broadcast(0.0f);
  std::uint32_t candidates = (1u << count) - 1;
  candidates &= ~(less(minimum(minimum(u, v), w), zero) & less(zero, maximum(maximum(u, v), w)));
  if (candidates == 0) return false;

  alignas(64) float t[8];
  alignas(64) double vs[8], ws[8], determinants[8];
  std::uint32_t hits = 0;
  const DoubleTag d;
  for (std::size_t i = 0; i < double_count; ++i) {
    const DoubleVector ax = promote(a.x, i), ay = promote(a.y, i), bx = promote(b.x, i), by = promote(b.y, i),
                       cx = promote(c.x, i), cy = promote(c.y, i);
    const DoubleVector u2 = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const DoubleVector v2 = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const DoubleVector w2 = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const DoubleVector none = hn::Zero(d);
    const auto differ =
        hn::And(hn::Lt(hn::Min(hn::Min(u2, v2), w2), none), hn::Lt(none, hn::Max(hn::Max(u2, v2), w2)));
    const DoubleVector determinant = hn::Add(hn::Add(u2, v2), w2);
    const DoubleVector z = hn::Add(hn::Add(hn::Mul(u2, promote(a.z, i)), hn::Mul(v2, promote(b.z, i))),
                                   hn::Mul(w2, promote(c.z, i)));
    const DoubleVector t2 = hn::Mul(hn::Div(z, determinant), hn::Set(d, ray.inverse_dz));
    const hn::Rebind<float, DoubleTag> narrow;
    hn::StoreU(hn::DemoteTo(narrow, t2), narrow, t + i * double_lanes);
    hn::StoreU(v2, d, vs + i * double_lanes);
    hn::StoreU(w2, d, ws + i * double_lanes);
    hn::StoreU(determinant, d, determinants + i * double_lanes);
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, differ, bytes);
    hits |= static_cast<std::uint32_t>(bytes[0]) << (i * double_lanes);
  }
  hits = candidates & ~hits;
  bool changed = false;
  for (; hits != 0; hits &= hits - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(hits));
    if (!(t[i] >= ray.t_min && t[i] <= best.t)) continue;
    const std::uint32_t primitive = words[9 * count + i];
    if (t[i] == best.t && primitive >= best.primitive) continue;
    best.t = t[i];
    best.u = static_cast<float>(vs[i] / determinants[i]);
    best.v = static_cast<float>(ws[i] / determinants[i]);
    best.primitive = primitive;
    changed = true;
  }
  return changed;
}

// Open nodes and leaves, with the distance at which the ray enters them. Every node leaves at most seven.
struct Stack {
  static constexpr std::size_t capacity = (wide_node_children - 1) * max_tree_depth + 2 * wide_node_children;
  std::uint32_t link[capacity];
  float t[capacity];
};

template <bool any_hit, bool counting>
HWY_ATTR Hit trace(const WideBvh& bvh, const Ray& caller_ray, TraversalCounters* counters) {
  Hit best;
  const PreparedRay ray(caller_ray);
  if (!ray.valid()) return best;
  const NodeRay node_ray(ray, bvh.bounds);
  const LeafRay leaf_ray(ray);
  best.t = ray.t_max;
  Eight t_best = broadcast(best.t);
  Stack stack;
  std::size_t depth = 0;
  ChildLink link = ChildLink::node(0);
  while (true) {
    while (!link.is_leaf()) {
      if constexpr (counting) ++counters->steps;
      const WideNode& node = bvh.nodes[link.node()];
      const float* planes = &node.planes[0][0][0];
      const auto plane = [&](std::size_t from, int axis, const Eight* constants) HWY_ATTR {
        return multiply_add(load(planes + from), node_ray.inverse[axis], constants[axis]);
      };
      const Eight first = maximum(
          maximum(plane(node_ray.near[0], 0, node_ray.enter), plane(node_ray.near[1], 1, node_ray.enter)),
          maximum(plane(node_ray.near[2], 2, node_ray.enter), node_ray.t_min));
      const Eight last = minimum(
          minimum(plane(node_ray.far[0], 0, node_ray.leave), plane(node_ray.far[1], 1, node_ray.leave)),
          minimum(plane(node_ray.far[2], 2, node_ray.leave), t_best));
      const std::uint32_t met = less_or_equal(first, last);
      if (met == 0) goto next;
      std::uint32_t order = node.order[node_ray.octant];
#if HWY_TARGET <= HWY_AVX2
      {
        const hn::RebindToUnsigned<FloatTag> du;
        alignas(32) static constexpr std::uint32_t shifts[8] = {21, 18, 15, 12, 9, 6, 3, 0};
        const auto slots = hn::And(hn::Shr(hn::Set(du, order), hn::Load(du, shifts)), hn::Set(du, 7u));
        const auto indices = hn::IndicesFromVec(FloatTag(), slots);
        const auto link_indices = hn::IndicesFromVec(du, slots);
        const auto mask =
            hn::Le(hn::TableLookupLanes(first.part[0], indices), hn::TableLookupLanes(last.part[0], indices));
        const auto links = hn::TableLookupLanes(
            hn::LoadU(du, reinterpret_cast<const std::uint32_t*>(node.children)), link_indices);
        hn::StoreU(hn::Compress(links, hn::RebindMask(du, mask)), du, stack.link + depth);
        hn::StoreU(hn::Compress(hn::TableLookupLanes(first.part[0], indices), mask), FloatTag(),
                   stack.t + depth);
        depth += static_cast<std::size_t>(std::popcount(met)) - 1;
        link = ChildLink(stack.link[depth]);
      }
#else
      alignas(32) float t[8];
      store(first, t);
      for (int place = 7; place >= 0; --place) {
        const std::uint32_t slot = (order >> (3 * place)) & 7;
        stack.link[depth] = node.children[slot].bits();
        stack.t[depth] = t[slot];
        depth += (met >> slot) & 1;
      }
      link = ChildLink(stack.link[--depth]);
#endif
    }
    if constexpr (counting) {
      ++counters->leaves;
      counters->triangle_tests += link.count();
    }
    if (intersect_leaf(leaf_ray, bvh.leaves.data() + words_per_triangle * link.first(), link.count(), best)) {
      if constexpr (any_hit) return best;
      t_best = broadcast(best.t);
    }
  next:
    do {
      if (depth == 0) {
        best.t = ray.unscaled(best.t);
        return best;
      }
      --depth;
    } while (stack.t[depth] > best.t);
    link = ChildLink(stack.link[depth]);
  }
}

HWY_ATTR Hit closest(const WideBvh& bvh, const Ray& ray) {
  return trace<false, false>(bvh, ray, nullptr);
}
HWY_ATTR bool any(const WideBvh& bvh, const Ray& ray) {
  return static_cast<bool>(trace<true, false>(bvh, ray, nullptr));
}
HWY_ATTR Hit closest_counted(const WideBvh& bvh, const Ray& ray, TraversalCounters& counters) {
  return trace<false, true>(bvh, ray, &counters);
}
HWY_ATTR bool any_counted(const WideBvh& bvh, const Ray& ray, TraversalCounters& counters) {
  return static_cast<bool>(trace<true, true>(bvh, ray, &counters));
}

}  // namespace

const Kernels* kernels() {
  static const Kernels table{.target = hwy::TargetName(HWY_TARGET),
                             .closest = closest,
                             .any = any,
                             .closest_counted = closest_counted,
                             .any_counted = any_counted};
  return &table;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cstdlib>
#include <string_view>

namespace kerf {

HWY_EXPORT(kernels);

const Kernels& choose_kernels() {
  std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS;
  const char* wanted = std::getenv("KERF_TARGET");
  for (std::int64_t rest = targets; wanted && rest != 0; rest &= rest - 1) {
    if (std::string_view(wanted) == hwy::TargetName(rest & -rest)) targets = rest & -rest;
  }
  hwy::ChosenTarget chosen;
  chosen.Update(targets);
  return *HWY_DISPATCH_TABLE(kernels)[chosen.GetIndex()]();
}

}  // namespace kerf
#endif
