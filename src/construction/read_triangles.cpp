#include "construction/read_triangles.hpp"

#include <algorithm>

#include "math/triangle.hpp"
#define KERF_FOUR_LANES
#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "construction/read_triangles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "construction/load_corner-inl.h"
#include "construction/sbvh/reference-inl.h"
#include "simd/box-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Whether the triangle certainly has an area: a component of the cross product of two edges is larger than
// rounding can make of zero. Edges, products and their difference are each off by 2^-24 of themselves, and
// products by the smallest float as well. Together that is less than 2^-21 of what is subtracted.
HWY_INLINE bool has_area(Float4 a, Float4 b, Float4 c) {
  alignas(16) static constexpr std::int32_t next_axis[4] = {1, 2, 0, 3};
  const auto to_next = hn::SetTableIndices(f32x4, next_axis);
  const Float4 u = hn::Sub(b, a), v = hn::Sub(c, a);
  const Float4 plus = hn::Mul(u, hn::TableLookupLanes(v, to_next));
  const Float4 minus = hn::Mul(hn::TableLookupLanes(u, to_next), v);
  const Float4 rounding = hn::Add(hn::Mul(hn::Add(hn::Abs(plus), hn::Abs(minus)), hn::Set(f32x4, 0x1p-20f)),
                                  hn::Set(f32x4, 0x1p-120f));
  const auto is_more = hn::Gt(hn::Abs(hn::Sub(plus, minus)), rounding);
  return !hn::AllFalse(f32x4, hn::And(is_more, hn::FirstN(f32x4, 3)));
}

ReadTriangles read_triangles(const Geometry& geometry, const TriangleRow& row, NonFinite non_finite,
                             Reference* references) {
  // Local copies: the compiler knows that stores to references do not change them.
  const TripleView<std::uint32_t> triangles = geometry.meshes()[row.mesh].triangles;
  const TripleView<float> vertices = geometry.meshes()[row.mesh].vertices;
  const std::uint32_t end = row.end, id_offset = row.first_id - row.begin;
  const Float4 limit = hn::Set(f32x4, coordinate_limit);
  const Float4 corner_mask = hn::Load(f32x4, reinterpret_cast<const float*>(corner_lanes));
  SimdBox all = empty_box(), centroids = all;
  std::uint32_t i = row.begin, count = 0, skipped = 0;
  for (; i < end; ++i) {
    const auto [i0, i1, i2] = triangles[i].values;
    if (HWY_MAX(HWY_MAX(i0, i1), i2) >= vertices.size()) break;
    const Float4 a = hn::And(load_corner(vertices, i0), corner_mask),
                 b = hn::And(load_corner(vertices, i1), corner_mask),
                 c = hn::And(load_corner(vertices, i2), corner_mask);
    const auto are_small =
        hn::And(hn::And(hn::Lt(hn::Abs(a), limit), hn::Lt(hn::Abs(b), limit)), hn::Lt(hn::Abs(c), limit));
    if (!hn::AllTrue(f32x4, are_small)) {
      if (non_finite == NonFinite::refuse) break;
      ++skipped;
      continue;
    }
    if (!has_area(a, b, c) && is_degenerate(geometry.triangle_of(row.mesh, i))) continue;
    const SimdBox box = from_halves(hn::Min(hn::Min(a, b), c), hn::Neg(hn::Max(hn::Max(a, b), c)));
    all = merge(all, box);
    centroids = merge(centroids, centroid_box(box));
    store_reference(box, id_offset + i, references[count++]);
  }
  ReadTriangles read;
  read.count = count;
  read.non_finite = skipped;
  if (i < end) read.wrong = id_offset + i;
  if (count != 0) {
    read.box = to_box3f(all);
    read.doubled_centroids = to_box3f(centroids);
  }
  return read;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(read_triangles);

ReadTriangles read_triangles(Target target, const Geometry& geometry, const TriangleRow& row,
                             NonFinite non_finite, Reference* references) {
  return KERF_DISPATCH(read_triangles, target)(geometry, row, non_finite, references);
}

}  // namespace kerf
#endif
