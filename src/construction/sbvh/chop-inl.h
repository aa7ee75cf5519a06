// A triangle, chopped at a plane.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_CHOP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_CHOP_INL_H
#undef KERF_CONSTRUCTION_SBVH_CHOP_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_CHOP_INL_H
#endif

#include <hwy/highway.h>

#include "construction/sbvh/reference-inl.h"
#include "math/clip.hpp"
#include "simd/box-inl.h"
#include "simd/triangle-inl.h"
#include "tree/geometry.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// As `chop` in math/clip.hpp, whose comments explain it. Here the three edges are treated alike, without a
// branch.
HWY_NOINLINE ChildBoxes chop(const Geometry& geometry, const Reference& reference, int axis, float plane) {
  const auto [primitive, mesh] = geometry.locate(reference.primitive);
  const TriangleMesh& m = geometry.meshes()[mesh];
  const auto [i0, i1, i2] = m.triangles[primitive].values;
  const Float4 corners[3] = {load_corner(m.vertices, i0), load_corner(m.vertices, i1),
                             load_corner(m.vertices, i2)};
  alignas(16) float along[3][4];
  for (int i = 0; i < 3; ++i) hn::Store(corners[i], f32x4, along[i]);
  const BoxMask before[3] = {box_mask(along[0][axis], plane), box_mask(along[1][axis], plane),
                             box_mask(along[2][axis], plane)};
  const BoxMask behind[3] = {box_mask(plane, along[0][axis]), box_mask(plane, along[1][axis]),
                             box_mask(plane, along[2][axis])};

  SimdBox left = empty_box(), right = left;
  for (int i = 0; i < 3; ++i) {
    const int j = i == 2 ? 0 : i + 1;
    const float a = along[i][axis], b = along[j][axis];
    const SimdBox corner = from_halves(corners[i], hn::Neg(corners[i]));
    left = merge_if_not(behind[i], left, corner);
    right = merge_if_not(before[i], right, corner);

    const Float4 t = hn::Set(f32x4, (plane - a) / (b - a));
    const Float4 at = hn::Add(corners[i], hn::Mul(t, hn::Sub(corners[j], corners[i])));
    const Float4 margin =
        hn::Add(hn::Mul(hn::Set(f32x4, chop_rounding), hn::Max(hn::Abs(corners[i]), hn::Abs(corners[j]))),
                hn::Set(f32x4, std::numeric_limits<float>::min()));
    const SimdBox crossing =
        from_halves(hn::Max(hn::Sub(at, margin), hn::Min(corners[i], corners[j])),
                    hn::Neg(hn::Min(hn::Add(at, margin), hn::Max(corners[i], corners[j]))));
    const BoxMask crosses = hn::Or(hn::And(before[i], behind[j]), hn::And(behind[i], before[j]));
    left = merge_if(crosses, left, crossing);
    right = merge_if(crosses, right, crossing);
  }
  const SimdBox box = load_box(reference);
  const auto on_axis = hn::Eq(hn::Iota(f32x4, 0.0f), hn::Set(f32x4, static_cast<float>(axis)));
  const Float4 nowhere = hn::Set(f32x4, -infinity);
  const SimdBox left_of_plane =
      from_halves(nowhere, hn::IfThenElse(on_axis, hn::Set(f32x4, -plane), nowhere));
  const SimdBox right_of_plane =
      from_halves(hn::IfThenElse(on_axis, hn::Set(f32x4, plane), nowhere), nowhere);
  return {intersect(intersect(left, left_of_plane), box), intersect(intersect(right, right_of_plane), box)};
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
