// Spatial splits: a plane parts the node, and references that straddle it go to both children (Stich,
// Friedrich & Dietrich 2009, section 4). Included once for each instruction set: see subtree.cpp.

#if defined(KERF_BUILD_SPATIAL_SPLIT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_BUILD_SPATIAL_SPLIT_INL
#undef KERF_BUILD_SPATIAL_SPLIT_INL
#else
#define KERF_BUILD_SPATIAL_SPLIT_INL
#endif

#include <algorithm>
#include <utility>

#include "build/object_split-inl.hpp"
#include "math/clip.hpp"
#include "tree/geometry.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

constexpr int spatial_bin_count = 32;

// The plane of each axis that is cheapest when boxes are chopped is looked at again with the triangles
// chopped, unless even so it costs this many times the object split. Without the limit three times as many
// triangles are chopped for a surface-area cost that differs by less than 0.1 %.
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

  HWY_INLINE bool straddled_by(const Reference& reference) const {
    return static_cast<int>(((&reference.lower.x)[axis] - origin) * scale < plane_number) &
           static_cast<int>(((&reference.upper.x)[axis] - origin) * scale > plane_number);
  }

  HWY_INLINE Side side_of(const Reference& reference) const {
    const bool begins_left = ((&reference.lower.x)[axis] - origin) * scale < plane_number;
    const bool ends_right = ((&reference.upper.x)[axis] - origin) * scale > plane_number;
    return !begins_left ? right : ends_right ? both : left;
  }
};

HWY_INLINE float half_area_of(const SimdBox& box) {
  alignas(16) float areas[4];
  hn::Store(half_areas(box, box, box), four, areas);
  return areas[0];
}

HWY_INLINE float half_area_or_zero(const SimdBox& box) {
  return is_empty(box) ? 0.0f : half_area_of(box);
}

// Corners without a negative zero: instruction sets disagree about which zero is the lesser.
HWY_INLINE Vec4 load_corner(const TripleView<float>& vertices, std::uint32_t index) {
  const std::byte* const at = vertices.data() + index * vertices.stride();
  Vec4 corner;
  if (index + 1 < vertices.size() && vertices.stride() >= 4) {  // a fourth float can be read
    corner = hn::LoadU(four, reinterpret_cast<const float*>(at));
  } else {
    alignas(16) float copy[4] = {};
    std::memcpy(copy, at, 3 * sizeof(float));
    corner = hn::Load(four, copy);
  }
  return hn::Add(corner, hn::Zero(four));
}

// As `chop` in math/clip.hpp, whose comments explain it; but the three edges are treated alike, without a
// branch.
HWY_NOINLINE ChildBoxes chop(const Geometry& geometry, const Reference& reference, int axis, float plane) {
  const auto [mesh, primitive] = geometry.locate(reference.primitive);
  const TriangleMesh& m = geometry.meshes()[mesh];
  const auto [i0, i1, i2] = m.triangles[primitive].values;
  const Vec4 corners[3] = {load_corner(m.vertices, i0), load_corner(m.vertices, i1),
                           load_corner(m.vertices, i2)};
  alignas(16) float along[3][4];
  for (int i = 0; i < 3; ++i) hn::Store(corners[i], four, along[i]);
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

    const Vec4 t = hn::Set(four, (plane - a) / (b - a));
    const Vec4 at = hn::Add(corners[i], hn::Mul(t, hn::Sub(corners[j], corners[i])));
    const Vec4 margin =
        hn::Add(hn::Mul(hn::Set(four, chop_rounding), hn::Max(hn::Abs(corners[i]), hn::Abs(corners[j]))),
                hn::Set(four, std::numeric_limits<float>::min()));
    const SimdBox crossing =
        from_halves(hn::Max(hn::Sub(at, margin), hn::Min(corners[i], corners[j])),
                    hn::Neg(hn::Min(hn::Add(at, margin), hn::Max(corners[i], corners[j]))));
    const BoxMask crosses = hn::Or(hn::And(before[i], behind[j]), hn::And(behind[i], before[j]));
    left = merge_if(crosses, left, crossing);
    right = merge_if(crosses, right, crossing);
  }
  const SimdBox box = load_box(reference);
  const auto on_axis = hn::Eq(hn::Iota(four, 0.0f), hn::Set(four, static_cast<float>(axis)));
  const Vec4 nowhere = hn::Set(four, -infinity);
  const SimdBox left_of_plane = from_halves(nowhere, hn::IfThenElse(on_axis, hn::Set(four, -plane), nowhere));
  const SimdBox right_of_plane = from_halves(hn::IfThenElse(on_axis, hn::Set(four, plane), nowhere), nowhere);
  return {intersect(intersect(left, left_of_plane), box), intersect(intersect(right, right_of_plane), box)};
}

// Chopped binning in two steps. In the first, a reference adds its box to the bin in which it begins and to
// the one in which it ends; a plane then bounds its left side by all that begins left of it, cut off at the
// plane, and its right side likewise. That is chopping boxes, and it takes no longer for a reference in many
// bins than for one in a single bin. In the second, the triangles themselves are chopped, but at the best
// plane of each axis alone.
struct SpatialBins {
  Bins begins, ends;
};

// How a box finds the bins in which it begins and ends.
struct SpatialBinner {
  SimdBox origin, scale;
  Vec4 last;

  // Writes where it begins on each axis, then where it ends.
  HWY_INLINE void find(const SimdBox& box, float* places) const {
    const SimdBox floors = floor_of_scaled(box, origin, scale);
    // A box that ends on a plane does not reach into the bin behind it: its last bin is the ceiling of its
    // end less one.
    const Vec4 first = lower_of(floors);
    const Vec4 end = hn::Max(hn::Sub(hn::Set(four, -1.0f), negated_upper_of(floors)), first);
    const Vec4 magic = hn::Set(four, bin_magic);
    store_bin(sum(merge(from_halves(first, end), from_halves(last, last)), from_halves(magic, magic)),
              places);
  }
};

HWY_INLINE SpatialBinner spatial_binner(const BinMapping& mapping) {
  const Vec4 origin = hn::Load(four, mapping.origin), scale = hn::Load(four, mapping.scale);
  return {from_halves(origin, hn::Neg(origin)), from_halves(scale, scale),
          hn::Set(four, static_cast<float>(spatial_bin_count - 1))};
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

// Both kinds of bins in one pass. Where spatial splits are possible at all, nearly all nodes come to look at
// them (19 of 20 references on sponza and a dragon), and neighbours often fall into the same bin, which the
// second must wait for: there is more to do meanwhile.
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
    const auto on_axis = hn::Eq(hn::Iota(four, 0.0f), hn::Set(four, static_cast<float>(axis)));
    const float width = (box.upper[axis] - box.lower[axis]) * (1.0f / static_cast<float>(spatial_bin_count));
    const Vec4 nowhere = hn::Set(four, -infinity), still = hn::Zero(four);
    const Vec4 from = hn::IfThenElse(on_axis, hn::Set(four, side * box.lower[axis]), nowhere);
    const Vec4 by = hn::IfThenElse(on_axis, hn::Set(four, side * width), still);
    first = side > 0.0f ? from_halves(from, nowhere) : from_halves(nowhere, from);
    step = side > 0.0f ? from_halves(by, still) : from_halves(still, by);
  }

  HWY_INLINE SimdBox at(int number) const { return move(first, step, static_cast<float>(number)); }
};

// The best plane of each axis with boxes chopped. Only planes that make at most `slack` references more
// count.
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
    const Vec4 areas = half_areas(intersect(x, behind[0].at(i)), intersect(y, behind[1].at(i)),
                                  intersect(z, behind[2].at(i)));
    hn::Store(areas, four, right_areas[i]);
  }
  x = y = z = empty_box();
  auto left = hn::Zero(four_ints), right = hn::Set(four_ints, static_cast<std::int32_t>(count));
  const Vec4 most = hn::Set(four, static_cast<float>(count) + static_cast<float>(slack));
  Vec4 best_cost = hn::Set(four, infinity), best_number = hn::Zero(four);
  for (int i = 1; i < spatial_bin_count; ++i) {
    x = merge(x, bins.begins.box(0, i - 1));
    y = merge(y, bins.begins.box(1, i - 1));
    z = merge(z, bins.begins.box(2, i - 1));
    left = hn::Add(left, bins.begins.counts(i - 1));
    right = hn::Sub(right, bins.ends.counts(i - 1));
    const Vec4 left_count = hn::ConvertTo(four, left), right_count = hn::ConvertTo(four, right);
    const Vec4 left_areas = half_areas(intersect(x, before[0].at(i)), intersect(y, before[1].at(i)),
                                       intersect(z, before[2].at(i)));
    const Vec4 cost =
        hn::Add(hn::Mul(left_areas, left_count), hn::Mul(hn::Load(four, right_areas[i]), right_count));
    const auto better = hn::And(hn::Lt(cost, best_cost), hn::Le(hn::Add(left_count, right_count), most));
    best_cost = hn::IfThenElse(better, cost, best_cost);
    best_number = hn::IfThenElse(better, hn::Set(four, static_cast<float>(i)), best_number);
  }
  alignas(16) float costs[4], numbers[4];
  hn::Store(best_cost, four, costs);
  hn::Store(best_number, four, numbers);
  PlaneCandidates candidates;
  for (int axis = 0; axis < 3; ++axis) {
    candidates.costs[axis] = costs[axis];
    candidates.numbers[axis] = static_cast<int>(numbers[axis]);
  }
  return candidates;
}

// Lists the references that straddle a plane, as many as fit into a vector at a time.
class StraddlerSearch {
  using Lanes = hn::CappedTag<float, 16>;
  using Numbers = hn::RebindToUnsigned<Lanes>;

 public:
  // Each reference takes two lanes, one for either corner.
  static constexpr std::uint32_t references = hn::MaxLanes(Lanes()) / 2;
  // How many numbers `find` writes over.
  static constexpr std::uint32_t most = hn::MaxLanes(Lanes());

  HWY_INLINE explicit StraddlerSearch(const SpatialSplit& split)
      : axis_(split.axis),
        origin_(hn::Set(lanes, split.origin)),
        scale_(hn::Set(lanes, split.scale)),
        plane_(hn::Set(lanes, split.plane_number)) {}

  // As SpatialSplit::straddled_by, for the references from `first` on. Writes their numbers, returns how many
  // they are.
  HWY_INLINE std::uint32_t find(const Reference* from, std::uint32_t first, std::uint32_t* to) const {
    hn::Vec<Lanes>
        corners[4];  // x, y and z of the lower and the upper corner of each by turns; their numbers
    hn::LoadInterleaved4(lanes, &from[first].lower.x, corners[0], corners[1], corners[2], corners[3]);
    const auto place = hn::Mul(hn::Sub(corners[axis_], origin_), scale_);
    const auto straddles = hn::And(hn::Lt(hn::DupEven(place), plane_), hn::Gt(hn::DupOdd(place), plane_));
    const auto one_lane_each = hn::Eq(hn::And(hn::Iota(numbers, 0), hn::Set(numbers, 1)), hn::Zero(numbers));
    const auto chosen = hn::And(hn::RebindMask(numbers, straddles), one_lane_each);
    const auto ids = hn::Add(hn::ShiftRight<1>(hn::Iota(numbers, 0)), hn::Set(numbers, first));
    hn::StoreU(hn::Compress(ids, chosen), numbers, to);
    return static_cast<std::uint32_t>(hn::CountTrue(numbers, chosen));
  }

 private:
  static constexpr Lanes lanes{};
  static constexpr Numbers numbers{};
  int axis_;
  hn::Vec<Lanes> origin_, scale_, plane_;
};

// What a plane costs when the triangles that straddle it are chopped. Not found where that is `limit` or
// more.
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
  for (int i = 0; i < number; ++i) {  // those wholly on the left end there
    left = merge(left, bins.ends.box(axis, i));
    left_count += bins.ends.count(axis, i);
  }
  for (int i = number; i < spatial_bin_count; ++i) {
    right = merge(right, bins.begins.box(axis, i));
    right_count += bins.begins.count(axis, i);
  }
  straddling -= left_count + right_count;
  // Chopping what straddles the plane can only add to these boxes, and nearly always adds to both counts.
  const auto least_cost = [&] {
    return half_area_or_zero(left) * static_cast<float>(left_count + straddling) +
           half_area_or_zero(right) * static_cast<float>(right_count + straddling);
  };
  constexpr std::uint32_t batch = 16;
  std::uint32_t straddlers[batch + StraddlerSearch::most];
  const StraddlerSearch search(split);
  for (std::uint32_t i = 0; i < count && straddling > 0;) {
    if (least_cost() >= limit) return split;
    std::uint32_t found = 0;
    for (; count - i >= StraddlerSearch::references && found < batch; i += StraddlerSearch::references)
      found += search.find(references, i, straddlers + found);
    for (; count - i < StraddlerSearch::references && i < count; ++i) {
      straddlers[found] = i;
      found += split.straddled_by(references[i]) ? 1 : 0;
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
  if (left_count == 0 || right_count == 0 || least_cost() >= limit) return split;
  split.left_count = static_cast<float>(left_count);
  split.right_count = static_cast<float>(right_count);
  split.boxes = {left, right};
  split.cost = least_cost();
  return split;
}

// The cheapest spatial split of what was binned, if it is cheaper than `object_split_cost`.
HWY_NOINLINE SpatialSplit find_spatial_split(const Geometry& geometry, const SpatialBins& bins,
                                             const BinMapping& mapping, const Reference* references,
                                             const Range& range, const Box3f& box, float object_split_cost) {
  const PlaneCandidates candidates = cheapest_planes(bins, box, range.count(), range.slack());
  SpatialSplit best;
  // The most promising first: what it costs is a limit that lets the others be given up sooner.
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

// Carries `split` out in place: references of the left child come first, those of the right follow, and run
// on into the slack where straddling references are divided. A straddling one is kept whole on one side if
// that costs less (reference unsplitting, section 4.4 of the paper).
struct SpatialPartition {
  std::uint32_t left_count, right_count;
  ChildBoxes boxes, centroids;
};

HWY_NOINLINE SpatialPartition partition(const Geometry& geometry, Reference* references, std::uint32_t count,
                                        const SpatialSplit& split) {
  // Both children as they would be if every straddling reference were divided; unsplitting grows the one and
  // takes from the other.
  SimdBox left_box = split.boxes.left, right_box = split.boxes.right;
  float left_count = split.left_count, right_count = split.right_count;
  std::uint32_t left_end = 0, right_begin = count, spare = count;
  ChildBoxes boxes{empty_box(), empty_box()}, centroids = boxes;
  const auto add_left = [&](const SimdBox& box) {
    boxes.left = merge(boxes.left, box);
    centroids.left = merge(centroids.left, centroid_box(box));
  };
  const auto add_right = [&](const SimdBox& box) {
    boxes.right = merge(boxes.right, box);
    centroids.right = merge(centroids.right, centroid_box(box));
  };
  while (left_end < right_begin) {
    Reference& reference = references[left_end];
    SpatialSplit::Side side = split.side_of(reference);
    if (side == SpatialSplit::both) {
      const ChildBoxes parts = chop(geometry, reference, split.axis, split.plane);
      if (is_empty(parts.right)) {
        side = SpatialSplit::left;
      } else if (is_empty(parts.left)) {
        side = SpatialSplit::right;
      } else {
        const SimdBox box = load_box(reference);
        const SimdBox grown_left = merge(left_box, box), grown_right = merge(right_box, box);
        const float left_area = half_area_of(left_box), right_area = half_area_of(right_box);
        const float divided = left_area * left_count + right_area * right_count;
        const float whole_left = half_area_of(grown_left) * left_count + right_area * (right_count - 1.0f);
        const float whole_right = left_area * (left_count - 1.0f) + half_area_of(grown_right) * right_count;
        if (right_count > 1.0f && whole_left <= divided && whole_left <= whole_right) {
          left_box = grown_left;
          right_count -= 1.0f;
          side = SpatialSplit::left;
        } else if (left_count > 1.0f && whole_right <= divided) {
          right_box = grown_right;
          left_count -= 1.0f;
          side = SpatialSplit::right;
        } else {
          const std::uint32_t primitive = reference.primitive;
          store_reference(parts.right, primitive, references[spare++]);
          add_right(parts.right);
          store_reference(parts.left, primitive, reference);
          side = SpatialSplit::left;
        }
      }
    }
    if (side == SpatialSplit::left) {
      add_left(load_box(reference));
      ++left_end;
    } else {
      add_right(load_box(reference));
      exchange(reference, references[--right_begin]);
    }
  }
  return {left_end, spare - left_end, boxes, centroids};
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif  // per target
