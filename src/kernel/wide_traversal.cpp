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

// Direction components of more or less than these are scaled first, see `PreparedRay`.
constexpr float least_length = 0x1p-8f, greatest_length = 0x1p20f;

// The axes of a ray's shear, for each axis of the largest component and its sign.
struct ShearAxes {
  std::uint8_t axis[3];
};
constexpr ShearAxes shear_axes[3][2] = {
    {{{1, 2, 0}}, {{2, 1, 0}}}, {{{2, 0, 1}}, {{0, 2, 1}}}, {{{0, 1, 2}}, {{1, 0, 2}}}};

// A ray as node steps and leaf tests need it: `RayBoxes` and `RayShear` once more, in vectors.
struct WideRay {
  Eight inverse[3], enter[3], leave[3], t_min;
  std::size_t near[3], far[3];  // where in a node the planes of entry and exit begin, in floats
  unsigned octant;

  Eight origin[3];  // along the shear's axes
  Eight sx, sy;
  double inverse_dz;
  std::size_t axis[3];
  float t_first;
};

HWY_INLINE void set_up(const PreparedRay& ray, const WideBvh& bvh, WideRay& out) {
  const float o[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const RayBoxes boxes(ray.origin, ray.direction, bvh.bounds);
  const float r[3] = {boxes.inverse.x, boxes.inverse.y, boxes.inverse.z};
  const float e[3] = {boxes.enter.x, boxes.enter.y, boxes.enter.z};
  const float l[3] = {boxes.leave.x, boxes.leave.y, boxes.leave.z};
  const RayShear shear(ray.direction);
  const int axes[3] = {shear.kx, shear.ky, shear.kz};
  out.octant = 0;
  for (int i = 0; i < 3; ++i) {
    out.octant |= static_cast<unsigned>(std::signbit(r[i])) << i;
    out.inverse[i] = broadcast(r[i]);
    out.enter[i] = broadcast(e[i]);
    out.leave[i] = broadcast(l[i]);
    out.axis[i] = static_cast<std::size_t>(axes[i]);
    out.origin[i] = broadcast(o[axes[i]]);
  }
  out.sx = broadcast(shear.sx);
  out.sy = broadcast(shear.sy);
  out.inverse_dz = shear.inverse_dz;
}

#if HWY_TARGET != HWY_SCALAR
template <int i>
HWY_INLINE Eight broadcast_lane(hn::Vec<hn::FixedTag<float, 4>> v) {
  Eight r;
#if HWY_TARGET <= HWY_AVX2
  const FloatTag d;
  r.part[0] = hn::TableLookupLanes(hn::ZeroExtendVector(d, v),
                                   hn::IndicesFromVec(d, hn::Set(hn::RebindToSigned<FloatTag>(), i)));
#else
  for (auto& part : r.part) part = hn::Broadcast<i>(v);
#endif
  return r;
}

HWY_INLINE bool set_up_fast(const Ray& ray, const WideBvh& bvh, WideRay& out) {
  const hn::FixedTag<float, 4> d4;
  const float* o_memory = &ray.origin.x;
  const float* d_memory = &ray.direction.x;
  const auto o = hn::LoadU(d4, o_memory), d = hn::LoadU(d4, d_memory);  // the fourth lane is something else
  const auto absolute = hn::Abs(d);
  const auto across = [](auto v) HWY_ATTR {
    return hn::Max(hn::Max(hn::Broadcast<0>(v), hn::Broadcast<1>(v)), hn::Broadcast<2>(v));
  };
  const auto largest = across(absolute);
  const auto distance = across(hn::Max(hn::Abs(hn::Sub(o, hn::LoadU(d4, &bvh.bounds.lower.x))),
                                       hn::Abs(hn::Sub(o, hn::LoadU(d4, &bvh.bounds.upper.x)))));
  const auto zero = hn::Zero(d4);
  const auto bits4 = [](auto mask) HWY_ATTR {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(hn::FixedTag<float, 4>(), mask, bytes);
    return unsigned{bytes[0]};
  };
  const unsigned finite = bits4(hn::Eq(hn::Mul(zero, hn::Add(o, d)), zero));
  const float length = hn::GetLane(largest);
  if (!((finite & 7) == 7 && length > least_length && length < greatest_length)) return false;

  const auto margin = hn::Mul(hn::Set(d4, 0x1p-24f), hn::Add(hn::Mul(distance, hn::Set(d4, 20.0f)),
                                                             hn::Set(d4, 4 * bvh.largest_coordinate)));
  const auto positive =
      hn::Div(hn::Set(d4, 1.0f), hn::Max(absolute, hn::Mul(largest, hn::Set(d4, 0x1p-26f))));
  const auto inverse = hn::CopySign(positive, d);
  const auto product = hn::Mul(o, inverse), grown = hn::Mul(margin, positive);
  const auto enter = hn::Sub(hn::Neg(product), grown), leave = hn::Sub(grown, product);
  out.inverse[0] = broadcast_lane<0>(inverse);
  out.inverse[1] = broadcast_lane<1>(inverse);
  out.inverse[2] = broadcast_lane<2>(inverse);
  out.enter[0] = broadcast_lane<0>(enter);
  out.enter[1] = broadcast_lane<1>(enter);
  out.enter[2] = broadcast_lane<2>(enter);
  out.leave[0] = broadcast_lane<0>(leave);
  out.leave[1] = broadcast_lane<1>(leave);
  out.leave[2] = broadcast_lane<2>(leave);
  out.octant = bits4(hn::MaskFromVec(
                   hn::BitCast(d4, hn::BroadcastSignBit(hn::BitCast(hn::FixedTag<std::int32_t, 4>(), d))))) &
               7;
  const auto kz = static_cast<unsigned>(31 - std::countl_zero(bits4(hn::Eq(absolute, largest)) & 7));
  const ShearAxes axes = shear_axes[kz][(out.octant >> kz) & 1];
  for (int i = 0; i < 3; ++i) {
    out.axis[i] = axes.axis[i];
    out.origin[i] = broadcast(o_memory[axes.axis[i]]);
  }
  out.sx = broadcast(d_memory[axes.axis[0]] / d_memory[kz]);
  out.sy = broadcast(d_memory[axes.axis[1]] / d_memory[kz]);
  out.inverse_dz = 1.0 / static_cast<double>(d_memory[kz]);
  return true;
}
#endif

struct Sheared {
  Eight x, y, z;
};

HWY_INLINE Sheared shear(const WideRay& ray, const float* vertex_rows, std::size_t count) {
  const Eight z = load(vertex_rows + ray.axis[2] * count) - ray.origin[2];
  return {load(vertex_rows + ray.axis[0] * count) - ray.origin[0] - ray.sx * z,
          load(vertex_rows + ray.axis[1] * count) - ray.origin[1] - ray.sy * z, z};
}

// `intersect_triangle` on all triangles of a leaf at once, operation by operation. Returns whether `best`
// changed.
HWY_INLINE bool intersect_leaf(const WideRay& ray, const std::uint32_t* words, std::uint32_t count,
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
    if (!(t[i] >= ray.t_first && t[i] <= best.t)) continue;
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
  WideRay wide_ray;
  double scale = 1.0;
#if HWY_TARGET != HWY_SCALAR
  if (HWY_LIKELY(set_up_fast(caller_ray, bvh, wide_ray))) {
    if (!(caller_ray.t_min <= caller_ray.t_max)) return best;
    wide_ray.t_first = std::max(caller_ray.t_min, 0.0f);
    best.t = std::min(caller_ray.t_max, std::numeric_limits<float>::max());
  } else
#endif
  {
    const PreparedRay ray(caller_ray);
    if (!ray.valid()) return best;
    set_up(ray, bvh, wide_ray);
    wide_ray.t_first = ray.t_min;
    best.t = ray.t_max;
    scale = ray.scale;
  }
  wide_ray.t_min = broadcast(wide_ray.t_first);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t negative = (wide_ray.octant >> axis) & 1;
    wide_ray.near[axis] = (2 * axis + negative) * wide_node_children;
    wide_ray.far[axis] = (2 * axis + 1 - negative) * wide_node_children;
  }
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
        return multiply_add(load(planes + from), wide_ray.inverse[axis], constants[axis]);
      };
      const Eight first = maximum(
          maximum(plane(wide_ray.near[0], 0, wide_ray.enter), plane(wide_ray.near[1], 1, wide_ray.enter)),
          maximum(plane(wide_ray.near[2], 2, wide_ray.enter), wide_ray.t_min));
      const Eight last = minimum(
          minimum(plane(wide_ray.far[0], 0, wide_ray.leave), plane(wide_ray.far[1], 1, wide_ray.leave)),
          minimum(plane(wide_ray.far[2], 2, wide_ray.leave), t_best));
      const std::uint32_t met = less_or_equal(first, last);
      if (met == 0) goto next;
#if HWY_TARGET <= HWY_AVX2
      if constexpr (any_hit) {
        const hn::RebindToUnsigned<FloatTag> du;
        const auto links = hn::LoadU(du, reinterpret_cast<const std::uint32_t*>(node.children));
        hn::StoreU(hn::Compress(links, hn::RebindMask(du, hn::Le(first.part[0], last.part[0]))), du,
                   stack.link + depth);
        depth += static_cast<std::size_t>(std::popcount(met)) - 1;
        link = ChildLink(stack.link[depth]);
        continue;
      }
#endif
      std::uint32_t order = node.order[wide_ray.octant];
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
    if (intersect_leaf(wide_ray, bvh.leaves.data() + words_per_triangle * link.first(), link.count(), best)) {
      if constexpr (any_hit) return best;
      t_best = broadcast(best.t);
    }
  next:
    if constexpr (any_hit) {
      if (depth == 0) return Hit{};
      link = ChildLink(stack.link[--depth]);
      continue;
    }
    do {
      if (depth == 0) {
        if (scale != 1.0) best.t = static_cast<float>(best.t / scale);
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
