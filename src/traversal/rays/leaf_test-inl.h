// A ray against all triangles of a leaf at once.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_LEAF_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_LEAF_TEST_INL_H
#undef KERF_TRAVERSAL_RAYS_LEAF_TEST_INL_H
#else
#define KERF_TRAVERSAL_RAYS_LEAF_TEST_INL_H
#endif

#include <bit>

#include <hwy/highway.h>

#include "math/ray_triangle.hpp"
#include "simd/floats-inl.h"
#include "traversal/rays/wide_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

struct Sheared {
  Float8 x, y, z;
};

HWY_INLINE Sheared shear(const LeafConstants& ray, const float* vertex_rows, std::size_t count) {
  const Float8 z = load(vertex_rows + ray.axis[2] * count) - ray.origin[2];
  return {load(vertex_rows + ray.axis[0] * count) - ray.origin[0] - ray.sx * z,
          load(vertex_rows + ray.axis[1] * count) - ray.origin[1] - ray.sy * z, z};
}

// Whether the hit at t comes before `best`. At the same t, the triangle with the lower number does.
HWY_INLINE bool is_before(float t, std::uint32_t primitive, const Hit& best) {
  return t < best.t || (t == best.t && primitive < best.primitive);
}

// Tests the triangles in `lanes` one by one: the few that single precision leaves open. Out of line, and
// without references to what would then no longer be kept in registers.
HWY_NOINLINE HWY_ATTR Hit intersect_one_by_one(const WideBvh& bvh, ChildLink leaf, std::uint32_t lanes,
                                               const Ray& ray, float t_min, Hit best) {
  const RayShear shear(ray.direction);
  for (; lanes != 0; lanes &= lanes - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(lanes));
    Hit hit;
    if (!intersect_triangle(shear, ray.origin, triangle_in(bvh, leaf, i), t_min, best.t, hit)) continue;
    hit.primitive = triangle_id(bvh, leaf, i);
    if (is_before(hit.t, hit.primitive, best)) best = hit;
  }
  return best;
}

// The operations of `intersect_triangle`, in its order, for all triangles of a leaf at once. Returns whether
// `best` changed. For `any_hit`, t, u and v of `best` are not written.
template <bool any_hit>
HWY_INLINE bool intersect_leaf(const LeafConstants& constants, const WideBvh& bvh, ChildLink leaf,
                               const Ray& ray, Hit& best) {
  using Limits = SinglePrecision;
  const std::uint32_t count = leaf.count();
  const std::uint32_t* words = bvh.leaves.data() + words_per_triangle * leaf.first();
  const float* rows = reinterpret_cast<const float*>(words);
  const Sheared a = shear(constants, rows, count), b = shear(constants, rows + 3 * count, count),
                c = shear(constants, rows + 6 * count, count);
  const Float8 u = difference_of_products(c.x, b.y, c.y, b.x), v = difference_of_products(a.x, c.y, a.y, c.x),
               w = difference_of_products(b.x, a.y, b.y, a.x);
  const Float8 min_edge = minimum(minimum(u, v), w), max_edge = maximum(maximum(u, v), w);
  std::uint32_t candidates = (1u << count) - 1;
  candidates &= ~(less(min_edge, broadcast(-Limits::min_sign)) & less(broadcast(Limits::min_sign), max_edge));
  if (candidates == 0) return false;

  const std::uint32_t trusted =
      less(constants.min_value, min_edge) | less(max_edge, broadcast(0.0f) - constants.min_value);
  bool changed = false;
  if (HWY_UNLIKELY((candidates & ~trusted) != 0)) {
    const Hit hit = intersect_one_by_one(bvh, leaf, candidates & ~trusted, ray, constants.t_min, best);
    changed = hit.t != best.t || hit.primitive != best.primitive;
    best = hit;
  }
  const Float8 inverse = broadcast(1.0f) / (u + v + w);
  const Float8 t = (u * a.z + v * b.z + w * c.z) * inverse * constants.inverse_dz;
  std::uint32_t hits = candidates & trusted & less_or_equal(broadcast(constants.t_min), t) &
                       less_or_equal(t, broadcast(best.t));
  if (hits == 0) return changed;
  const std::uint32_t* ids = words + 9 * count;
  if constexpr (any_hit) {
    best.primitive = *ids;
    return true;
  }
  alignas(64) float ts[8], us[8], vs[8];
  store(t, ts);
  store(v * inverse, us);
  store(w * inverse, vs);
  for (; hits != 0; hits &= hits - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(hits));
    const std::uint32_t primitive = ids[i];
    if (!is_before(ts[i], primitive, best)) continue;
    best.t = ts[i];
    best.u = us[i];
    best.v = vs[i];
    best.primitive = primitive;
    changed = true;
  }
  return changed;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
