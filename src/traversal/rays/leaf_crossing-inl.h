// Where a ray crosses a triangle of a leaf: t, u and v as `crossing_of` of math/ray_crossing.hpp gives them.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_LEAF_CROSSING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_LEAF_CROSSING_INL_H
#undef KERF_TRAVERSAL_RAYS_LEAF_CROSSING_INL_H
#else
#define KERF_TRAVERSAL_RAYS_LEAF_CROSSING_INL_H
#endif

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <hwy/highway.h>
#include <kerf/bvh.hpp>

#include "layout/wide_bvh.hpp"
#include "math/ray_triangle.hpp"
#include "simd/targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

// Out of line: where double precision does not suffice, which is rare.
HWY_NOINLINE HWY_ATTR RayCrossing hit_exactly(const WideBvh& bvh, ChildLink leaf, std::uint32_t i,
                                              const Ray& ray) {
  const Triangle triangle = triangle_in(bvh, leaf, i);
  const CrossingEstimate estimate = estimate_crossing(ray.origin, ray.direction, triangle);
  if (estimate.steep() && estimate.precise()) return estimate.crossing(estimate.height);
  const RayShear shear(ray.direction);
  Hit hit;
  const float infinity = std::numeric_limits<float>::infinity();
  if (!intersect_triangle(shear, ray.origin, ray.direction, triangle, -infinity, infinity, hit))
    return {infinity, 0.0f, 0.0f};
  return {hit.t, hit.u, hit.v};
}

// In line where double precision suffices, so that results stay in registers: three floats that a call
// returns go through memory, where the caller has to wait for them.
#if KERF_FLOAT_LANES >= 8
// `estimate_crossing` operation by operation, two numbers at a time: e beside f, and d beside p. With SSE4,
// whose instructions write over what they read, that is no faster.
HWY_INLINE RayCrossing hit_in_leaf(const WideBvh& bvh, ChildLink leaf, std::uint32_t i, const Ray& ray) {
  using Estimate = CrossingEstimate;
  const hn::FixedTag<double, 2> tag;
  const hn::FixedTag<float, 2> floats;
  using Pair = hn::Vec<hn::FixedTag<double, 2>>;
  const auto pair_of = [&](float p, float q) HWY_ATTR {
    return hn::PromoteTo(tag, hn::InterleaveLower(floats, hn::Set(floats, p), hn::Set(floats, q)));
  };
  const auto turned = [](Pair a) HWY_ATTR { return hn::Shuffle01(a); };
  const auto largest_of = [](const Pair* a) HWY_ATTR {
    return hn::Max(hn::Max(hn::Abs(a[0]), hn::Abs(a[1])), hn::Abs(a[2]));
  };
  const auto numbers = [&](double p, double q) HWY_ATTR {
    alignas(16) const double lanes[2] = {p, q};
    return hn::Load(tag, lanes);
  };

  const float* rows = leaf_rows(bvh, leaf) + i;
  const std::size_t count = leaf.count();
  const float origin[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const float direction[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  Pair ef[3], dp[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Pair da = pair_of(direction[axis], rows[axis * count]);
    ef[axis] = hn::Sub(pair_of(rows[(3 + axis) * count], rows[(6 + axis) * count]), hn::DupOdd(da));
    dp[axis] = hn::Sub(da, pair_of(0.0f, origin[axis]));
  }
  // The cross product of the first and the second of each pair; each component twice.
  const auto cross_pair = [&](const Pair* a, Pair* product) HWY_ATTR {
    const Pair x = hn::Mul(a[1], turned(a[2])), y = hn::Mul(a[2], turned(a[0])),
               z = hn::Mul(a[0], turned(a[1]));
    const Pair xy = hn::Sub(hn::InterleaveLower(tag, x, y), hn::InterleaveUpper(tag, x, y));
    product[0] = hn::DupEven(xy);
    product[1] = hn::DupOdd(xy);
    product[2] = hn::Sub(hn::DupEven(z), hn::DupOdd(z));
  };
  const auto dot_pair = [](const Pair* a, const Pair* b) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
  };
  Pair n[3], r[3];
  cross_pair(ef, n);
  cross_pair(dp, r);
  const Pair slope_height = dot_pair(dp, n);
  const Pair slope = hn::DupEven(slope_height);
  const Pair one_t = hn::Div(slope_height, slope);
  const Pair v_u = hn::Div(dot_pair(ef, r), hn::Xor(slope, numbers(0.0, -0.0)));

  const Pair edge_sizes = largest_of(ef);
  const Pair edges = hn::Mul(edge_sizes, turned(edge_sizes)), normal = largest_of(n);
  const Pair least = hn::Mul(hn::Mul(numbers(Estimate::min_slope, Estimate::min_precise), largest_of(dp)),
                             hn::InterleaveLower(tag, normal, edges));
  const Pair zero = hn::Zero(tag), one = hn::Set(tag, 1.0), size = hn::Abs(one_t);
  // No number that `round_crossing` would change.
  const auto plain = hn::And(
      hn::And(hn::And(hn::Ge(size, hn::Set(tag, 0x1p-126)), hn::Lt(size, hn::Set(tag, 0x1p127))),
              hn::And(hn::Ge(v_u, zero), hn::Le(hn::Add(v_u, turned(v_u)), one))),
      hn::And(hn::Ge(hn::Abs(slope_height), least),
              hn::Ge(normal, hn::Mul(edges, hn::Set(tag, Estimate::min_precise / Estimate::min_slope)))));
  if (HWY_UNLIKELY(!hn::AllTrue(tag, plain))) return hit_exactly(bvh, leaf, i, ray);
  const auto narrow = hn::DemoteTo(floats, v_u);
  const auto t = hn::DemoteTo(floats, hn::DupOdd(one_t));
  return {hn::GetLane(t), hn::GetLane(hn::DupOdd(narrow)), hn::GetLane(narrow)};
}
#else
HWY_INLINE RayCrossing hit_in_leaf(const WideBvh& bvh, ChildLink leaf, std::uint32_t i, const Ray& ray) {
  const CrossingEstimate estimate = estimate_crossing(ray.origin, ray.direction, triangle_in(bvh, leaf, i));
  const double t = estimate.height / estimate.slope, u = estimate.u / estimate.slope,
               v = estimate.v / estimate.slope;
  // No number that `round_crossing` would change. As numbers, so that the compiler makes one branch of all.
  const auto is = [](bool holds) { return static_cast<unsigned>(holds); };
  const unsigned plain = is(std::abs(t) >= 0x1p-126) & is(std::abs(t) < 0x1p127) & is(u >= 0.0) &
                         is(v >= 0.0) & is(u + v <= 1.0);
  if (HWY_LIKELY((plain & is(estimate.steep()) & is(estimate.precise())) != 0))
    return {static_cast<float>(t), static_cast<float>(u), static_cast<float>(v)};
  return hit_exactly(bvh, leaf, i, ray);
}
#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
