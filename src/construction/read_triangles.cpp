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

#include "construction/sbvh/reference-inl.h"
#include "simd/box-inl.h"
#include "simd/triangle-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

ReadTriangles read_triangles(const Geometry& geometry, const TriangleRow& row, NonFinite non_finite,
                             Reference* references) {
  // Local copies: the compiler knows that stores to references do not change them.
  const TripleView<std::uint32_t> triangles = geometry.meshes()[row.mesh].triangles;
  const TripleView<float> vertices = geometry.meshes()[row.mesh].vertices;
  const std::uint32_t end = row.end, id_offset = row.first_id - row.begin;
  const Float4 corner_mask = hn::Load(f32x4, reinterpret_cast<const float*>(corner_lanes));
  SimdBox all = empty_box(), centroids = all;
  std::uint32_t i = row.begin, count = 0, skipped = 0;
  for (; i < end; ++i) {
    const auto [i0, i1, i2] = triangles[i].values;
    if (HWY_MAX(HWY_MAX(i0, i1), i2) >= vertices.size()) break;
    const Float4 a = hn::And(load_corner(vertices, i0), corner_mask),
                 b = hn::And(load_corner(vertices, i1), corner_mask),
                 c = hn::And(load_corner(vertices, i2), corner_mask);
    if (!is_in_range(a, b, c)) {
      if (non_finite == NonFinite::refuse) break;
      ++skipped;
      continue;
    }
    if (!has_area(a, b, c) && is_degenerate(geometry.triangle_of(row.mesh, i))) continue;
    const SimdBox box = bounds_of(a, b, c);
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
