// A ray against the triangles of a leaf, as many at once as a vector has lanes.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_LEAF_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_LEAF_TEST_INL_H
#undef KERF_TRAVERSAL_RAYS_LEAF_TEST_INL_H
#else
#define KERF_TRAVERSAL_RAYS_LEAF_TEST_INL_H
#endif

#include <algorithm>
#include <bit>

#include <hwy/highway.h>

#include "math/ray_triangle.hpp"
#include "simd/floats-inl.h"
#include "traversal/rays/leaf_crossing-inl.h"
#include "traversal/rays/prepared_ray.hpp"
#include "traversal/rays/wide_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

struct Sheared {
  LeafFloats x, y, z;
};

HWY_INLINE Sheared shear(const LeafConstants& ray, const float* vertex_rows, std::size_t count) {
  const auto row = [&](int i) HWY_ATTR { return load<leaf_group>(vertex_rows + ray.axis[i] * count); };
  const LeafFloats z = row(2) - ray.origin[2];
  return {row(0) - ray.origin[0] - ray.sx * z, row(1) - ray.origin[1] - ray.sy * z, z};
}

// The triangles of a leaf of `count` from `begin` on that are tested at once, a bit for each.
HWY_INLINE std::uint32_t lanes_of_group(std::uint32_t begin, std::uint32_t count) {
  return (1u << std::min(count - begin, std::uint32_t{leaf_group})) - 1;
}

// Which hits count: all of them.
struct NoFilter {
  static constexpr bool filters = false;
  bool operator()(std::uint32_t, const RayCrossing&) const { return true; }
};

// Which hits count: those that a caller accepts. It is asked about a triangle in each leaf in which the ray
// meets it, but only while that is nearer than all that has been accepted.
struct HitFilter {
  static constexpr bool filters = true;
  void* context;
  bool (*accept)(void* context, const Hit& hit);
  const PreparedRay* prepared = nullptr;  // of a ray that has been scaled
  const Ray* caller = nullptr;            // that ray as it was given, whose range decides

  bool operator()(std::uint32_t primitive, const RayCrossing& crossing) const {
    float t = crossing.t;
    if (prepared != nullptr) {
      t = prepared->unscaled(t);
      if (!(t >= caller->t_min && t <= caller->t_max)) return false;
    }
    return accept(context, {.t = t, .u = crossing.u, .v = crossing.v, .primitive = primitive});
  }
};

// The nearest triangle found so far. Its t is known to lie between two bounds, which is enough to go on with;
// what it is exactly is computed when another triangle's might be less, and when the ray is done. So no
// branch waits for double precision.
struct Nearest {
  float first, last;  // bounds of t; t itself where both are the same
  std::uint32_t primitive = invalid_id;
  std::uint32_t link = 0, lane = 0;  // where the triangle stands

  // 0 in place of -0: node steps may compare numbers as integers.
  explicit Nearest(float t_max = 0.0f) : first(t_max + 0.0f), last(first) {}
};

HWY_INLINE Hit settled_hit(const WideBvh& bvh, const Ray& ray, const Nearest& nearest) {
  if (nearest.primitive == invalid_id) return Hit{};
  const RayCrossing crossing = hit_in_leaf(bvh, ChildLink(nearest.link), nearest.lane, ray);
  return {.t = crossing.t, .u = crossing.u, .v = crossing.v, .primitive = nearest.primitive};
}

HWY_INLINE void take_if_lower(std::uint32_t primitive, ChildLink leaf, std::uint32_t i, Nearest& best) {
  if (primitive >= best.primitive) return;
  best.primitive = primitive;
  best.link = leaf.bits();
  best.lane = i;
}

// Out of line, with nothing by reference that is in registers otherwise: triangle `i`, whose t may be less
// than that of `best` or not, or may lie before `t_min` or not. Of equal ones the triangle with the lowest
// number is nearer. `filter` is asked last.
template <class Filter>
HWY_NOINLINE HWY_ATTR Nearest nearer_of(const WideBvh& bvh, ChildLink leaf, std::uint32_t i, const Ray& ray,
                                        float t_min, const Filter& filter, Nearest best) {
  if constexpr (!Filter::filters) {
    // A ray meets both at the same t then, of which nothing need be known: their numbers decide.
    if (best.primitive != invalid_id && same_corners(bvh, leaf, i, ChildLink(best.link), best.lane)) {
      take_if_lower(triangle_id(bvh, leaf, i), leaf, i, best);
      return best;
    }
  }
  const RayCrossing crossing = hit_in_leaf(bvh, leaf, i, ray);
  const float t = crossing.t;
  if (!(t >= t_min)) return best;
  if (best.first != best.last)
    best.first = best.last = hit_in_leaf(bvh, ChildLink(best.link), best.lane, ray).t;
  const std::uint32_t primitive = triangle_id(bvh, leaf, i);
  if (t > best.first || (t == best.first && primitive >= best.primitive)) return best;
  if (!filter(primitive, crossing)) return best;
  best.first = best.last = t;
  best.primitive = primitive;
  best.link = leaf.bits();
  best.lane = i;
  return best;
}

// The triangles in `lanes` one by one: for the few that single precision leaves open.
template <class Filter>
HWY_NOINLINE HWY_ATTR Nearest intersect_one_by_one(const WideBvh& bvh, ChildLink leaf, std::uint32_t lanes,
                                                   const Ray& ray, float t_min, const Filter& filter,
                                                   Nearest best) {
  const RayShear shear(ray.direction);
  for (; lanes != 0; lanes &= lanes - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(lanes));
    Hit hit;
    if (intersect_triangle(shear, ray.origin, ray.direction, triangle_in(bvh, leaf, i), t_min, best.last,
                           hit))
      best = nearer_of(bvh, leaf, i, ray, t_min, filter, best);
  }
  return best;
}

// An edge function a * b - c * d: its value as it is computed, and what it lies between.
#if HWY_NATIVE_FMA
struct Edges {
  LeafFloats value;
  HWY_INLINE LeafFloats low() const { return value; }
  HWY_INLINE LeafFloats high() const { return value; }
};
#else
struct Edges {
  LeafFloats value, least, greatest;
  HWY_INLINE LeafFloats low() const { return least; }
  HWY_INLINE LeafFloats high() const { return greatest; }
};
#endif
HWY_INLINE Edges edges(const LeafFloats& a, const LeafFloats& b, const LeafFloats& c, const LeafFloats& d) {
#if HWY_NATIVE_FMA
  return {difference_of_products(a, b, c, d)};
#else
  // Without fused multiplication and addition exact ones cost ten times as much as rounded ones. These have
  // three roundings of 2^-24, and one more of the bounds themselves.
  const LeafFloats ab = a * b, cd = c * d, value = ab - cd;
  const LeafFloats error = (absolute(ab) + absolute(cd)) * broadcast<leaf_group>(0x1p-22f);
  return {value, value - error, value + error};
#endif
}

// `intersect_triangle` on a group of triangles at once: the edge functions to within bounds or operation by
// operation, and t to within bounds. Returns whether `best` changed; where any hit will do, that is all that
// `best` tells.
template <bool any_hit, class Filter>
HWY_INLINE bool intersect_group(const LeafConstants& constants, const WideBvh& bvh, ChildLink leaf,
                                std::uint32_t begin, const Ray& ray, const Filter& filter, Nearest& best) {
  using Limits = SinglePrecision;
  const std::uint32_t count = leaf.count();
  const std::uint32_t* words = bvh.leaves.data() + words_per_triangle * leaf.first();
  const float* rows = reinterpret_cast<const float*>(words) + begin;
  const Sheared a = shear(constants, rows, count), b = shear(constants, rows + 3 * count, count),
                c = shear(constants, rows + 6 * count, count);
  const Edges u = edges(c.x, b.y, c.y, b.x), v = edges(a.x, c.y, a.y, c.x), w = edges(b.x, a.y, b.y, a.x);
  const auto least = [](const LeafFloats& p, const LeafFloats& q, const LeafFloats& r)
                         HWY_ATTR { return minimum(minimum(p, q), r); };
  const auto greatest = [](const LeafFloats& p, const LeafFloats& q, const LeafFloats& r)
                            HWY_ATTR { return maximum(maximum(p, q), r); };
  std::uint32_t candidates = lanes_of_group(begin, count);
  candidates &= ~(less(least(u.high(), v.high(), w.high()), broadcast<leaf_group>(-Limits::min_sign)) &
                  less(broadcast<leaf_group>(Limits::min_sign), greatest(u.low(), v.low(), w.low())));
  if (candidates == 0) return false;

  // What t is for the point that the weights name, and how far from it the ray may cross the plane: the
  // shear's rounding, times how much the triangle rises along the ray for each step across it. Weights that
  // are off by as much as `doubt` move that point by no more than that part of the triangle's extent in z.
  const LeafFloats area = u.value + v.value + w.value;
  const LeafFloats inverse = broadcast<leaf_group>(1.0f) / area;
  const LeafFloats t = (u.value * a.z + v.value * b.z + w.value * c.z) * inverse * constants.inverse_dz;
  const LeafFloats ab_z = absolute(b.z - a.z), ac_z = absolute(c.z - a.z);
  const LeafFloats rise =
      (absolute(b.x - a.x) + absolute(b.y - a.y)) * ac_z + (absolute(c.x - a.x) + absolute(c.y - a.y)) * ab_z;
  LeafFloats error = constants.error_of_mean + constants.error_of_shear * rise * absolute(inverse);
  LeafFloats doubt = broadcast<leaf_group>(0.0f);
#if !HWY_NATIVE_FMA
  doubt = (u.high() - u.low()) + (v.high() - v.low()) + (w.high() - w.low());
  error = error + doubt * (ab_z + ac_z) * absolute(inverse * constants.inverse_dz);
#endif
  const LeafFloats first = t - error, last = t + error;
  const LeafFloats t_min = broadcast<leaf_group>(constants.t_min), t_max = broadcast<leaf_group>(best.last);
  const std::uint32_t after_start = less_or_equal(t_min, first);
  const std::uint32_t trusted =
      less(constants.min_value, least(u.low(), v.low(), w.low())) |
      less(greatest(u.high(), v.high(), w.high()), broadcast<leaf_group>(0.0f) - constants.min_value);
  if constexpr (any_hit && !Filter::filters) {
    if ((candidates & trusted & after_start & less_or_equal(last, t_max)) != 0) {
      best.primitive = words[9 * count];
      return true;
    }
  }
  const std::uint32_t in_range = less_or_equal(t_min, last) & less_or_equal(first, t_max);
  bool changed = false;
  if (HWY_UNLIKELY((candidates & ~trusted) != 0)) {
    // The bounds hold where one weight is large enough: triangles around a vertex that the ray begins at are
    // out of range, although some of their weights are 0.
    const std::uint32_t bounded = less(constants.min_value, absolute(area) - doubt);
    const std::uint32_t open = candidates & ~trusted & (in_range | ~bounded);
    if (open != 0) {
      const Nearest other =
          intersect_one_by_one(bvh, leaf, open << begin, ray, constants.t_min, filter, best);
      changed = other.primitive != best.primitive;
      best = other;
      if (any_hit && changed) return true;
    }
  }
  std::uint32_t near = candidates & trusted & in_range;
  if (near == 0) return changed;
  // Candidates are known some forty cycles before their t. Most often all of them are hits, which a branch
  // foretells: then the number of the triangle, and what is computed of it when the ray is done, need not
  // wait for t. Compilers must not see that both are the same.
  if (HWY_LIKELY(near == candidates)) {
    near = candidates;
    __asm__ volatile("" : "+r"(near));
  }
  const std::uint32_t* ids = words + 9 * count + begin;
  alignas(32) float firsts[leaf_group], lasts[leaf_group];
  store(first, firsts);
  store(last, lasts);
  for (; near != 0; near &= near - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(near));
    if (!any_hit && !Filter::filters && HWY_LIKELY(((after_start >> i & 1) != 0) & (lasts[i] < best.first))) {
      best.first = firsts[i];
      best.last = lasts[i];
      best.primitive = ids[i];
      best.link = leaf.bits();
      best.lane = begin + i;
      changed = true;
      continue;
    }
    if (firsts[i] > best.last) continue;
    const Nearest other = nearer_of(bvh, leaf, begin + i, ray, constants.t_min, filter, best);
    changed |= other.primitive != best.primitive;
    best = other;
    if (any_hit && changed) return true;
  }
  return changed;
}
template <bool any_hit, class Filter = NoFilter>
HWY_INLINE bool intersect_leaf(const LeafConstants& constants, const WideBvh& bvh, ChildLink leaf,
                               const Ray& ray, Nearest& best, const Filter& filter = {}) {
  if constexpr (leaf_group == wide_leaf_triangles)
    return intersect_group<any_hit>(constants, bvh, leaf, 0, ray, filter, best);
  bool changed = false;
  for (std::uint32_t begin = 0; begin < leaf.count(); begin += leaf_group) {
    changed |= intersect_group<any_hit>(constants, bvh, leaf, begin, ray, filter, best);
    if (any_hit && changed) return true;
  }
  return changed;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
