// Spatial splits: a plane parts the node, and references that straddle it go to both children (Stich,
// Friedrich & Dietrich 2009, section 4).
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_SPATIAL_SPLIT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_SPATIAL_SPLIT_INL_H
#undef KERF_CONSTRUCTION_SBVH_SPATIAL_SPLIT_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_SPATIAL_SPLIT_INL_H
#endif

#include <algorithm>
#include <utility>

#include <hwy/highway.h>

#include "construction/sbvh/arena.hpp"
#include "construction/sbvh/chop-inl.h"
#include "construction/sbvh/spatial_bins-inl.h"
#include "simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// The cheapest plane of each axis by chopped boxes is evaluated again with chopped triangles, unless it costs
// more than this many times the object split. Without the limit three times as many triangles are chopped,
// and the surface-area cost differs by less than 0.1 %.
constexpr float worth_chopping = 1.4f;

// References with x = (lower - origin) * scale < plane number begin left of the plane, those with
// (upper - origin) * scale > plane number end right of it.
struct SpatialSplit {
  float cost = infinity;  // as that of an object split
  int axis = 0;
  float origin = 0.0f, scale = 0.0f;
  float plane_number = 0.0f;
  float plane = 0.0f;
  float left_count = 0.0f, right_count = 0.0f;
  ChildBoxes boxes{};

  enum Side { left, both, right };

  HWY_INLINE bool begins_left(const Reference& reference) const {
    return ((&reference.lower.x)[axis] - origin) * scale < plane_number;
  }
  HWY_INLINE bool ends_right(const Reference& reference) const {
    return ((&reference.upper.x)[axis] - origin) * scale > plane_number;
  }
  HWY_INLINE Side side_of(const Reference& reference) const {
    return !begins_left(reference) ? right : ends_right(reference) ? both : left;
  }
};

// Lists the references that straddle a plane. A vector's worth of references is tested at a time.
class StraddlerSearch {
  using Lanes = hn::CappedTag<float, 16>;
  using Numbers = hn::RebindToUnsigned<Lanes>;

 public:
  // Each reference takes two lanes, one for either corner.
  static constexpr std::uint32_t references = hn::MaxLanes(Lanes()) / 2;
  // `find` may write to this many places, whatever it finds.
  static constexpr std::uint32_t written = hn::MaxLanes(Lanes());

  HWY_INLINE explicit StraddlerSearch(const SpatialSplit& split)
      : axis_(split.axis),
        origin_(hn::Set(lanes, split.origin)),
        scale_(hn::Set(lanes, split.scale)),
        plane_(hn::Set(lanes, split.plane_number)) {}

  // As SpatialSplit::side_of, for `references` references from `first` on. Writes the numbers of those that
  // straddle and returns how many there are.
  HWY_INLINE std::uint32_t find(const Reference* from, std::uint32_t first, std::uint32_t* to) const {
    // x, y and z of the corners, lower and upper interleaved, and the references' numbers.
    hn::Vec<Lanes> corners[4];
    hn::LoadInterleaved4(lanes, &from[first].lower.x, corners[0], corners[1], corners[2], corners[3]);
    const auto place = hn::Mul(hn::Sub(corners[axis_], origin_), scale_);
    const auto straddles = hn::And(hn::Lt(hn::DupEven(place), plane_), hn::Gt(hn::DupOdd(place), plane_));
    const auto one_lane_each = hn::Eq(hn::And(hn::Iota(numbers, 0), hn::Set(numbers, 1)), hn::Zero(numbers));
    const auto chosen = hn::And(hn::RebindMask(numbers, straddles), one_lane_each);
    const auto ids = hn::Add(hn::ShiftRight<1>(hn::Iota(numbers, 0)), hn::Set(numbers, first));
    hn::StoreU(compress(ids, chosen), numbers, to);
    return static_cast<std::uint32_t>(hn::CountTrue(numbers, chosen));
  }

 private:
  static constexpr Lanes lanes{};
  static constexpr Numbers numbers{};
  int axis_;
  hn::Vec<Lanes> origin_, scale_, plane_;
};

// The cost of a plane when the triangles that straddle it are chopped. The search is given up, with an
// infinite cost, once the cost cannot be below `limit`.
HWY_NOINLINE SpatialSplit chop_at(const Geometry& geometry, const SpatialBins& bins,
                                  const Reference* references, std::uint32_t count, const Box3f& box,
                                  const BinMapping& mapping, int axis, int number, float limit) {
  SpatialSplit split;
  split.axis = axis;
  split.origin = mapping.origin[axis];
  split.scale = mapping.scale[axis];
  split.plane_number = static_cast<float>(number);
  split.plane = plane_at(box, axis, number);
  SimdBox left = empty_box(), right = left;
  std::int32_t left_count = 0, right_count = 0, straddling = static_cast<std::int32_t>(count);
  for (int i = 0; i < number; ++i) {  // references wholly on the left end in these bins
    left = merge(left, bins.ends.box(axis, i));
    left_count += bins.ends.count(axis, i);
  }
  for (int i = number; i < spatial_bin_count; ++i) {
    right = merge(right, bins.begins.box(axis, i));
    right_count += bins.begins.count(axis, i);
  }
  straddling -= left_count + right_count;
  // A lower bound, or nearly so: chopping straddling triangles only grows these boxes, and nearly always adds
  // one to both counts.
  const auto min_cost = [&] {
    return half_area_or_zero(left) * static_cast<float>(left_count + straddling) +
           half_area_or_zero(right) * static_cast<float>(right_count + straddling);
  };
  // Few, so that planes are given up early; but enough for the fetches of their vertices to overlap.
  constexpr std::uint32_t batch = 16;
  std::uint32_t straddlers[batch + StraddlerSearch::written];
  const StraddlerSearch search(split);
  for (std::uint32_t i = 0; i < count && straddling > 0;) {
    if (min_cost() >= limit) return split;
    std::uint32_t found = 0;
    for (; count - i >= StraddlerSearch::references && found < batch; i += StraddlerSearch::references)
      found += search.find(references, i, straddlers + found);
    for (; count - i < StraddlerSearch::references && i < count; ++i) {
      straddlers[found] = i;
      found +=
          std::uint32_t{split.begins_left(references[i])} & std::uint32_t{split.ends_right(references[i])};
    }
    straddling -= static_cast<std::int32_t>(found);
    for (std::uint32_t k = 0; k < found; ++k) geometry.prefetch_indices(references[straddlers[k]].primitive);
    for (std::uint32_t k = 0; k < found; ++k) geometry.prefetch_corners(references[straddlers[k]].primitive);
    for (std::uint32_t k = 0; k < found; ++k) {
      const ChildBoxes parts = chop(geometry, references[straddlers[k]], axis, split.plane);
      if (!is_empty(parts.left)) {
        left = merge(left, parts.left);
        ++left_count;
      }
      if (!is_empty(parts.right)) {
        right = merge(right, parts.right);
        ++right_count;
      }
    }
  }
  if (left_count == 0 || right_count == 0 || min_cost() >= limit) return split;
  split.left_count = static_cast<float>(left_count);
  split.right_count = static_cast<float>(right_count);
  split.boxes = {left, right};
  split.cost = min_cost();
  return split;
}

// The cheapest spatial split of what was binned, if it is cheaper than `object_split_cost`.
HWY_NOINLINE SpatialSplit find_spatial_split(const Geometry& geometry, const SpatialBins& bins,
                                             const BinMapping& mapping, const Reference* references,
                                             const Range& range, const Box3f& box, float object_split_cost) {
  const PlaneCandidates candidates = cheapest_planes(bins, box, range.count(), range.slack());
  SpatialSplit best;
  // The most promising axis comes first: its cost is a limit with which the others are given up sooner.
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int a, int b) {
    return std::pair(candidates.costs[a], a) < std::pair(candidates.costs[b], b);
  });
  for (const int axis : order) {
    if (!(candidates.costs[axis] < worth_chopping * object_split_cost)) break;
    if (mapping.scale[axis] == 0.0f) continue;
    const SpatialSplit split = chop_at(geometry, bins, references, range.count(), box, mapping, axis,
                                       candidates.numbers[axis], std::min(object_split_cost, best.cost));
    if (split.cost < best.cost) best = split;
  }
  return best;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
