// Object splits: every reference goes to one child. The cheapest of the splits between bins.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_OBJECT_SPLIT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_OBJECT_SPLIT_INL_H
#undef KERF_CONSTRUCTION_SBVH_OBJECT_SPLIT_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_OBJECT_SPLIT_INL_H
#endif

#include <hwy/highway.h>

#include "construction/sbvh/bins-inl.h"
#include "construction/sbvh/reference-inl.h"
#include "simd/box-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// Bins on each axis. Up to `few_references`, half as many lose nothing: docs/decisions/0013.
constexpr int object_bin_count = 32;
constexpr int few_object_bin_count = 16;
constexpr std::uint32_t few_references = 256;

// References whose doubled centroid c on `axis` gives (c - origin) * scale < threshold go left.
struct ObjectSplit {
  float cost = infinity;  // half area times references, summed over both children
  int axis = 0;
  float origin = 0.0f, scale = 1.0f, threshold = 0.0f;

  bool found() const { return cost < infinity; }
};

HWY_INLINE float doubled_centroid(const Reference& reference, int axis) {
  return (&reference.lower.x)[axis] + (&reference.upper.x)[axis];
}

// Finds the bins of a box by its centroid.
struct ObjectBinner {
  Float4 origin, scale, last;

  HWY_INLINE void find(const SimdBox& box, float* places) const {
    const Float4 place = hn::Mul(hn::Sub(doubled_centroid(box), origin), scale);
    hn::Store(hn::Add(hn::Min(hn::Floor(place), last), hn::Set(f32x4, bin_magic)), f32x4, places);
  }
};

HWY_INLINE ObjectBinner object_binner(const BinMapping& mapping, int bin_count) {
  return {hn::Load(f32x4, mapping.origin), hn::Load(f32x4, mapping.scale),
          hn::Set(f32x4, static_cast<float>(bin_count - 1))};
}

HWY_NOINLINE void fill(Bins& bins, const Reference* references, std::uint32_t count,
                       const BinMapping& mapping, int bin_count) {
  const ObjectBinner binner = object_binner(mapping, bin_count);
  clear(bins, bin_count);
  alignas(16) float places[binning_lead][4];
  bin_ahead(
      count, [&](auto i, auto slot) { binner.find(load_box(references[i]), places[slot]); },
      [&](auto i, auto slot) { add(bins, places[slot], counted_once(load_box(references[i]))); });
}

// The cheapest plane between bins, over three axes at a time.
HWY_NOINLINE ObjectSplit cheapest(const Bins& bins, std::uint32_t count, const BinMapping& mapping,
                                  int bin_count) {
  alignas(16) float right_areas[max_bin_count][4];
  SimdBox x = empty_box(), y = x, z = x;
  for (int i = bin_count - 1; i > 0; --i) {
    x = merge(x, bins.box(0, i));
    y = merge(y, bins.box(1, i));
    z = merge(z, bins.box(2, i));
    hn::Store(half_areas(x, y, z), f32x4, right_areas[i]);
  }
  x = y = z = empty_box();
  auto left = hn::Zero(i32x4);
  const Float4 total = hn::Set(f32x4, static_cast<float>(count));
  Float4 best_cost = hn::Set(f32x4, infinity), best_plane = hn::Zero(f32x4);
  for (int i = 1; i < bin_count; ++i) {
    x = merge(x, bins.box(0, i - 1));
    y = merge(y, bins.box(1, i - 1));
    z = merge(z, bins.box(2, i - 1));
    left = hn::Add(left, bins.counts(i - 1));
    const Float4 left_count = hn::ConvertTo(f32x4, left);
    // An empty side has infinite area and no references. The product is not a number, which never compares as
    // less.
    const Float4 cost = hn::Add(hn::Mul(half_areas(x, y, z), left_count),
                                hn::Mul(hn::Load(f32x4, right_areas[i]), hn::Sub(total, left_count)));
    const auto better = hn::Lt(cost, best_cost);
    best_cost = hn::IfThenElse(better, cost, best_cost);
    best_plane = hn::IfThenElse(better, hn::Set(f32x4, static_cast<float>(i)), best_plane);
  }
  alignas(16) float costs[4], planes[4];
  hn::Store(best_cost, f32x4, costs);
  hn::Store(best_plane, f32x4, planes);
  ObjectSplit split;
  for (int axis = 0; axis < 3; ++axis) {
    if (costs[axis] < split.cost && mapping.scale[axis] > 0.0f) {
      split = {costs[axis], axis, mapping.origin[axis], mapping.scale[axis], planes[axis]};
    }
  }
  return split;
}

// The boxes of the children of a binned split.
HWY_INLINE ChildBoxes child_boxes(const Bins& bins, const ObjectSplit& split, int bin_count) {
  ChildBoxes boxes{empty_box(), empty_box()};
  const int plane = static_cast<int>(split.threshold);
  for (int i = 0; i < plane; ++i) boxes.left = merge(boxes.left, bins.box(split.axis, i));
  for (int i = plane; i < bin_count; ++i) boxes.right = merge(boxes.right, bins.box(split.axis, i));
  return boxes;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
