// A ray against all triangles of a leaf at once. Included once per instruction set.

#if defined(KERF_LEAF_TEST_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_LEAF_TEST_INL
#undef KERF_LEAF_TEST_INL
#else
#define KERF_LEAF_TEST_INL
#endif

#include <bit>

#include "kernel/eight_lanes-inl.h"
#include "kernel/wide_ray-inl.h"
#include "math/ray_triangle.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

struct Sheared {
  Eight x, y, z;
};

HWY_INLINE Sheared shear(const LeafConstants& ray, const float* vertex_rows, std::size_t count) {
  const Eight z = load(vertex_rows + ray.axis[2] * count) - ray.origin[2];
  return {load(vertex_rows + ray.axis[0] * count) - ray.origin[0] - ray.sx * z,
          load(vertex_rows + ray.axis[1] * count) - ray.origin[1] - ray.sy * z, z};
}

// Whether the hit at t comes before `best`: of equal ones the triangle with the lowest number does.
HWY_INLINE bool is_before(float t, std::uint32_t primitive, const Hit& best) {
  return t < best.t || (t == best.t && primitive < best.primitive);
}

// The triangles in `lanes` by `intersect_exactly`. Out of line, and by value, so that nothing has to be in
// memory for its sake.
HWY_NOINLINE HWY_ATTR Hit intersect_exactly(const Sheared* corners, std::uint32_t lanes, float dz,
                                            float t_min, const std::uint32_t* ids, Hit best) {
  alignas(64) float lane[3][3][8];
  for (std::size_t i = 0; i < 3; ++i) {
    store(corners[i].x, lane[i][0]);
    store(corners[i].y, lane[i][1]);
    store(corners[i].z, lane[i][2]);
  }
  for (; lanes != 0; lanes &= lanes - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(lanes));
    const auto corner = [&](std::size_t k) {
      return ShearedCorner(lane[k][0][i], lane[k][1][i], lane[k][2][i]);
    };
    Hit hit;
    if (!kerf::intersect_exactly(corner(0), corner(1), corner(2), dz, t_min, best.t, hit)) continue;
    hit.primitive = ids[i];
    if (is_before(hit.t, hit.primitive, best)) best = hit;
  }
  return best;
}

// `intersect_triangle` on all triangles of a leaf at once, operation by operation. Returns whether `best`
// changed.
HWY_INLINE bool intersect_leaf(const LeafConstants& ray, const std::uint32_t* words, std::uint32_t count,
                               Hit& best) {
  using Limits = SinglePrecision;
  const float* rows = reinterpret_cast<const float*>(words);
  const std::uint32_t* ids = words + 9 * count;
  const Sheared a = shear(ray, rows, count), b = shear(ray, rows + 3 * count, count),
                c = shear(ray, rows + 6 * count, count);
  const Eight u = difference_of_products(c.x, b.y, c.y, b.x), v = difference_of_products(a.x, c.y, a.y, c.x),
              w = difference_of_products(b.x, a.y, b.y, a.x);
  const Eight least = minimum(minimum(u, v), w), greatest = maximum(maximum(u, v), w);
  std::uint32_t candidates = (1u << count) - 1;
  candidates &=
      ~(less(least, broadcast(-Limits::least_sign)) & less(broadcast(Limits::least_sign), greatest));
  if (candidates == 0) return false;

  const Eight determinant = u + v + w;
  const Eight inverse = broadcast(1.0f) / determinant;
  const Eight t = (u * a.z + v * b.z + w * c.z) * inverse * ray.inverse_dz;
  const std::uint32_t trusted =
      (less(broadcast(Limits::least_value), least) | less(greatest, broadcast(-Limits::least_value))) &
      less(absolute(determinant), broadcast(Limits::greatest)) &
      less(absolute(t), broadcast(Limits::greatest));
  bool changed = false;
  if (HWY_UNLIKELY((candidates & ~trusted) != 0)) {
    const Sheared corners[] = {a, b, c};
    const Hit hit = intersect_exactly(corners, candidates & ~trusted, ray.dz, ray.t_min, ids, best);
    changed = hit.t != best.t || hit.primitive != best.primitive;
    best = hit;
  }
  std::uint32_t hits =
      candidates & trusted & less_or_equal(broadcast(ray.t_min), t) & less_or_equal(t, broadcast(best.t));
  if (hits == 0) return changed;
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
