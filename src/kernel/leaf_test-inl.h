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

// Covers the rounding of distances in single precision, 2^-23.
constexpr float above = 1.0f + 0x1p-20f;

// `intersect_triangle` on all triangles of a leaf at once, operation by operation. Returns whether `best`
// changed.
HWY_INLINE bool intersect_leaf(const LeafConstants& ray, const std::uint32_t* words, std::uint32_t count,
                               Hit& best) {
  const float* rows = reinterpret_cast<const float*>(words);
  const Sheared a = shear(ray, rows, count), b = shear(ray, rows + 3 * count, count),
                c = shear(ray, rows + 6 * count, count);
  const Eight u = c.x * b.y - c.y * b.x, v = a.x * c.y - a.y * c.x, w = b.x * a.y - b.y * a.x;
  const Eight zero = broadcast(0.0f);
  std::uint32_t candidates = (1u << count) - 1;
  candidates &= ~(less(minimum(minimum(u, v), w), zero) & less(zero, maximum(maximum(u, v), w)));
  // t is a mean of the vertices' distances: what lies behind the best hit as a whole, or before t_min, is
  // out.
  const Eight at_a = a.z * ray.inverse_dz_float, at_b = b.z * ray.inverse_dz_float,
              at_c = c.z * ray.inverse_dz_float;
  candidates &= ~less(broadcast(best.t * above), minimum(minimum(at_a, at_b), at_c));
  candidates &= ~less(maximum(maximum(at_a, at_b), at_c), ray.t_min_below);
  if (candidates == 0) return false;

  alignas(64) float t[8];
  alignas(64) double vs[8], ws[8], inverses[8];
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
    const DoubleVector inverse = hn::Div(hn::Set(d, 1.0), determinant);
    const DoubleVector t2 = hn::Mul(hn::Mul(z, inverse), hn::Set(d, ray.inverse_dz));
    const hn::Rebind<float, DoubleTag> narrow;
    hn::StoreU(hn::DemoteTo(narrow, t2), narrow, t + i * double_lanes);
    hn::StoreU(v2, d, vs + i * double_lanes);
    hn::StoreU(w2, d, ws + i * double_lanes);
    hn::StoreU(inverse, d, inverses + i * double_lanes);
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
    best.u = static_cast<float>(vs[i] * inverses[i]);
    best.v = static_cast<float>(ws[i] * inverses[i]);
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
