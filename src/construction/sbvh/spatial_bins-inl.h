// Spatial splits, first step: references in bins, and the most promising plane of each axis.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_SPATIAL_BINS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_SPATIAL_BINS_INL_H
#undef KERF_CONSTRUCTION_SBVH_SPATIAL_BINS_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_SPATIAL_BINS_INL_H
#endif

#include <hwy/highway.h>

#include "construction/sbvh/bins-inl.h"
#include "construction/sbvh/object_split-inl.h"
#include "construction/sbvh/reference-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

constexpr int spatial_bin_count = 32;

// Chopped binning in two steps. In the first, a reference adds its box to the bin in which it begins and to
// the bin in which it ends. The left side of a plane is then bounded by all boxes that begin left of it, cut
// off at the plane, and the right side likewise. This chops boxes, and a reference in many bins takes no
// longer than one in a single bin. In the second step, the triangles themselves are chopped, but only at the
// best plane of each axis.
struct SpatialBins {
  Bins begins, ends;
};

// How a box finds the bins in which it begins and ends.
struct SpatialBinner {
  SimdBox origin, scale;
  Float4 last;

  // Writes where it begins on each axis, then where it ends.
  HWY_INLINE void find(const SimdBox& box, float* places) const {
    const SimdBox floors = floor_of_scaled(box, origin, scale);
    // A box that ends on a plane does not reach into the bin behind it: its last bin is the ceiling of its
    // end less one.
    const Float4 first = lower_of(floors);
    const Float4 end = hn::Max(hn::Sub(hn::Set(f32x4, -1.0f), negated_upper_of(floors)), first);
    const Float4 magic = hn::Set(f32x4, bin_magic);
    store_bin(sum(merge(from_halves(first, end), from_halves(last, last)), from_halves(magic, magic)),
              places);
  }
};

HWY_INLINE SpatialBinner spatial_binner(const BinMapping& mapping) {
  const Float4 origin = hn::Load(f32x4, mapping.origin), scale = hn::Load(f32x4, mapping.scale);
  return {from_halves(origin, hn::Neg(origin)), from_halves(scale, scale),
          hn::Set(f32x4, static_cast<float>(spatial_bin_count - 1))};
}

HWY_NOINLINE void fill(SpatialBins& bins, const Reference* references, std::uint32_t count,
                       const BinMapping& mapping) {
  const SpatialBinner binner = spatial_binner(mapping);
  clear(bins.begins, spatial_bin_count);
  clear(bins.ends, spatial_bin_count);
  alignas(32) float places[binning_lead][8];
  bin_ahead(
      count, [&](auto i, auto slot) { binner.find(load_box(references[i]), places[slot]); },
      [&](auto i, auto slot) {
        const SimdBox box = counted_once(load_box(references[i]));
        add(bins.begins, places[slot], box);
        add(bins.ends, places[slot] + 4, box);
      });
}

// Both kinds of bins in one pass. Where spatial splits are possible, nearly all nodes evaluate them (19 of 20
// references on sponza and a dragon). Neighbouring references often fall into the same bin, so that the
// second waits for the first: filling other bins meanwhile hides that.
HWY_NOINLINE void fill(Bins& object_bins, const BinMapping& object_mapping, int object_bin_count,
                       SpatialBins& spatial_bins, const BinMapping& spatial_mapping,
                       const Reference* references, std::uint32_t count) {
  const ObjectBinner object = object_binner(object_mapping, object_bin_count);
  const SpatialBinner spatial = spatial_binner(spatial_mapping);
  clear(object_bins, object_bin_count);
  clear(spatial_bins.begins, spatial_bin_count);
  clear(spatial_bins.ends, spatial_bin_count);
  alignas(32) float centers[binning_lead][4], places[binning_lead][8];
  bin_ahead(
      count,
      [&](auto i, auto slot) {
        const SimdBox box = load_box(references[i]);
        object.find(box, centers[slot]);
        spatial.find(box, places[slot]);
      },
      [&](auto i, auto slot) {
        const SimdBox box = counted_once(load_box(references[i]));
        add(object_bins, centers[slot], box);
        add(spatial_bins.begins, places[slot], box);
        add(spatial_bins.ends, places[slot] + 4, box);
      });
}

HWY_INLINE float plane_at(const Box3f& box, int axis, int number) {
  const float width = (box.upper[axis] - box.lower[axis]) * (1.0f / static_cast<float>(spatial_bin_count));
  return box.lower[axis] + static_cast<float>(number) * width;
}

// The half spaces beside the planes of one axis, as boxes to intersect with.
struct HalfSpaces {
  SimdBox first, step;

  // Behind each plane if `side` is 1, before it if -1.
  HWY_INLINE HalfSpaces(const Box3f& box, int axis, float side) {
    const auto on_axis = hn::Eq(hn::Iota(f32x4, 0.0f), hn::Set(f32x4, static_cast<float>(axis)));
    const float width = (box.upper[axis] - box.lower[axis]) * (1.0f / static_cast<float>(spatial_bin_count));
    const Float4 nowhere = hn::Set(f32x4, -infinity), still = hn::Zero(f32x4);
    const Float4 from = hn::IfThenElse(on_axis, hn::Set(f32x4, side * box.lower[axis]), nowhere);
    const Float4 by = hn::IfThenElse(on_axis, hn::Set(f32x4, side * width), still);
    first = side > 0.0f ? from_halves(from, nowhere) : from_halves(nowhere, from);
    step = side > 0.0f ? from_halves(by, still) : from_halves(still, by);
  }

  HWY_INLINE SimdBox at(int number) const { return move(first, step, static_cast<float>(number)); }
};

// The best plane of each axis with boxes chopped, among those that make at most `slack` additional
// references.
struct PlaneCandidates {
  float costs[3];
  int numbers[3];
};
HWY_NOINLINE PlaneCandidates cheapest_planes(const SpatialBins& bins, const Box3f& box, std::uint32_t count,
                                             std::uint32_t slack) {
  const HalfSpaces behind[3] = {{box, 0, 1.0f}, {box, 1, 1.0f}, {box, 2, 1.0f}};
  const HalfSpaces before[3] = {{box, 0, -1.0f}, {box, 1, -1.0f}, {box, 2, -1.0f}};
  alignas(16) float right_areas[spatial_bin_count][4];
  SimdBox x = empty_box(), y = x, z = x;
  for (int i = spatial_bin_count - 1; i > 0; --i) {
    x = merge(x, bins.ends.box(0, i));
    y = merge(y, bins.ends.box(1, i));
    z = merge(z, bins.ends.box(2, i));
    const Float4 areas = half_areas(intersect(x, behind[0].at(i)), intersect(y, behind[1].at(i)),
                                    intersect(z, behind[2].at(i)));
    hn::Store(areas, f32x4, right_areas[i]);
  }
  x = y = z = empty_box();
  auto left = hn::Zero(i32x4), right = hn::Set(i32x4, static_cast<std::int32_t>(count));
  const Float4 max_count = hn::Set(f32x4, static_cast<float>(count) + static_cast<float>(slack));
  Float4 best_cost = hn::Set(f32x4, infinity), best_number = hn::Zero(f32x4);
  for (int i = 1; i < spatial_bin_count; ++i) {
    x = merge(x, bins.begins.box(0, i - 1));
    y = merge(y, bins.begins.box(1, i - 1));
    z = merge(z, bins.begins.box(2, i - 1));
    left = hn::Add(left, bins.begins.counts(i - 1));
    right = hn::Sub(right, bins.ends.counts(i - 1));
    const Float4 left_count = hn::ConvertTo(f32x4, left), right_count = hn::ConvertTo(f32x4, right);
    const Float4 left_areas = half_areas(intersect(x, before[0].at(i)), intersect(y, before[1].at(i)),
                                         intersect(z, before[2].at(i)));
    const Float4 cost =
        hn::Add(hn::Mul(left_areas, left_count), hn::Mul(hn::Load(f32x4, right_areas[i]), right_count));
    const auto better = hn::And(hn::Lt(cost, best_cost), hn::Le(hn::Add(left_count, right_count), max_count));
    best_cost = hn::IfThenElse(better, cost, best_cost);
    best_number = hn::IfThenElse(better, hn::Set(f32x4, static_cast<float>(i)), best_number);
  }
  alignas(16) float costs[4], numbers[4];
  hn::Store(best_cost, f32x4, costs);
  hn::Store(best_number, f32x4, numbers);
  PlaneCandidates candidates;
  for (int axis = 0; axis < 3; ++axis) {
    candidates.costs[axis] = costs[axis];
    candidates.numbers[axis] = static_cast<int>(numbers[axis]);
  }
  return candidates;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
