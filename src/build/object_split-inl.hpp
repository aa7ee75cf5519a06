// Object splits: every reference goes whole to one child.
// Included once for each instruction set: see subtree.cpp.

#if defined(KERF_BUILD_OBJECT_SPLIT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_BUILD_OBJECT_SPLIT_INL
#undef KERF_BUILD_OBJECT_SPLIT_INL
#else
#define KERF_BUILD_OBJECT_SPLIT_INL
#endif

#include <array>
#include <cstring>

#include "build/simd_box-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// Bins on each axis. Up to `few_references`, half of them lose nothing: see docs/decisions.md.
constexpr int object_bin_count = 32;
constexpr int few_object_bin_count = 16;
constexpr std::uint32_t few_references = 256;

// Up to this many references every split between neighbouring centroids is tried: two vectors of eight
// candidates.
constexpr std::uint32_t sweep_limit = 16;

// References whose doubled centroid c on `axis` gives (c - origin) * scale < threshold go left.
struct ObjectSplit {
  float cost = infinity;  // half area times references, summed over both children
  int axis = 0;
  float origin = 0.0f, scale = 1.0f, threshold = 0.0f;

  bool found() const { return cost < infinity; }
};

struct ChildBoxes {
  SimdBox left, right;
};

HWY_INLINE float doubled_centroid(const Reference& reference, int axis) {
  return (&reference.lower.x)[axis] + (&reference.upper.x)[axis];
}

// Bins of all three axes side by side, so that one pass over them evaluates three splits at a time.
struct ObjectBins {
  alignas(32) float boxes[object_bin_count][3][8];
  alignas(16) std::int32_t counts[object_bin_count][4];

  HWY_INLINE void clear(int bins) {
    const SimdBox none = empty_box();
    for (int i = 0; i < bins; ++i) {
      for (int axis = 0; axis < 3; ++axis) store_bin(none, boxes[i][axis]);
      hn::Store(hn::Zero(four_ints), four_ints, counts[i]);
    }
  }
};

// From coordinates to bins on three axes; an axis too short to be parted has scale 0.
struct BinMapping {
  alignas(16) float origin[4];
  alignas(16) float scale[4];

  BinMapping(const Box3f& box, int bins) {
    for (int axis = 0; axis < 3; ++axis) {
      const float size = box.upper[axis] - box.lower[axis];
      const float s = static_cast<float>(bins) / size;
      origin[axis] = box.lower[axis];
      scale[axis] = size > 0.0f && s <= std::numeric_limits<float>::max() ? s : 0.0f;
    }
    origin[3] = scale[3] = 0.0f;
  }
};

HWY_NOINLINE void fill(ObjectBins& bins, const Reference* references, std::uint32_t count,
                       const BinMapping& mapping, int bin_count) {
  const Vec4 origin = hn::Load(four, mapping.origin), scale = hn::Load(four, mapping.scale);
  const auto last = hn::Set(four_ints, bin_count - 1);
  for (std::uint32_t i = 0; i < count; ++i) {
    const SimdBox box = load_box(references[i]);
    const Vec4 place = hn::Mul(hn::Sub(doubled_centroid(box), origin), scale);
    const auto index = hn::Min(hn::ConvertTo(four_ints, place), last);
    alignas(16) std::int32_t bin[4];
    hn::Store(index, four_ints, bin);
    for (int axis = 0; axis < 3; ++axis) {
      float* const slot = bins.boxes[bin[axis]][axis];
      store_bin(merge(load_bin(slot), box), slot);
      ++bins.counts[bin[axis]][axis];
    }
  }
}

// The cheapest plane between bins, over three axes at a time.
HWY_NOINLINE ObjectSplit cheapest(const ObjectBins& bins, std::uint32_t count, const BinMapping& mapping,
                                  int bin_count) {
  alignas(16) float right_areas[object_bin_count][4];
  SimdBox x = empty_box(), y = x, z = x;
  for (int i = bin_count - 1; i > 0; --i) {
    x = merge(x, load_bin(bins.boxes[i][0]));
    y = merge(y, load_bin(bins.boxes[i][1]));
    z = merge(z, load_bin(bins.boxes[i][2]));
    hn::Store(half_areas(x, y, z), four, right_areas[i]);
  }
  x = y = z = empty_box();
  auto left = hn::Zero(four_ints);
  const Vec4 total = hn::Set(four, static_cast<float>(count));
  Vec4 best_cost = hn::Set(four, infinity), best_plane = hn::Zero(four);
  for (int i = 1; i < bin_count; ++i) {
    x = merge(x, load_bin(bins.boxes[i - 1][0]));
    y = merge(y, load_bin(bins.boxes[i - 1][1]));
    z = merge(z, load_bin(bins.boxes[i - 1][2]));
    left = hn::Add(left, hn::Load(four_ints, bins.counts[i - 1]));
    const Vec4 left_count = hn::ConvertTo(four, left);
    // An empty side has infinite area and no references: not a number, which is less than nothing.
    const Vec4 cost = hn::Add(hn::Mul(half_areas(x, y, z), left_count),
                              hn::Mul(hn::Load(four, right_areas[i]), hn::Sub(total, left_count)));
    const auto better = hn::Lt(cost, best_cost);
    best_cost = hn::IfThenElse(better, cost, best_cost);
    best_plane = hn::IfThenElse(better, hn::Set(four, static_cast<float>(i)), best_plane);
  }
  alignas(16) float costs[4], planes[4];
  hn::Store(best_cost, four, costs);
  hn::Store(best_plane, four, planes);
  ObjectSplit split;
  for (int axis = 0; axis < 3; ++axis) {
    if (costs[axis] < split.cost && mapping.scale[axis] > 0.0f) {
      split = {costs[axis], axis, mapping.origin[axis], mapping.scale[axis], planes[axis]};
    }
  }
  return split;
}

// What the children of a binned split would enclose.
HWY_INLINE ChildBoxes child_boxes(const ObjectBins& bins, const ObjectSplit& split, int bin_count) {
  ChildBoxes boxes{empty_box(), empty_box()};
  const int plane = static_cast<int>(split.threshold);
  for (int i = 0; i < plane; ++i) boxes.left = merge(boxes.left, load_bin(bins.boxes[i][split.axis]));
  for (int i = plane; i < bin_count; ++i)
    boxes.right = merge(boxes.right, load_bin(bins.boxes[i][split.axis]));
  return boxes;
}

// The least float above x.
HWY_INLINE float next_above(float x) {
  if (x == 0.0f) return std::numeric_limits<float>::denorm_min();
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits += x > 0.0f ? 1u : ~0u;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

// Every split between neighbouring centroids. There is no sorting: each lane is one candidate, a reference on
// an axis, and sends left what lies no further along the axis than the candidate. All look at the references
// in turn.
HWY_NOINLINE ObjectSplit sweep(const Reference* references, std::uint32_t count) {
  using Lanes = hn::CappedTag<float, 16>;
  constexpr Lanes lanes;
  using Vec = hn::Vec<Lanes>;
  constexpr std::uint32_t width = hn::MaxLanes(Lanes());
  static_assert(3 * sweep_limit % width == 0);

  // keys[axis * count + i] is candidate i of an axis; behind the last stand candidates that send all to the
  // left.
  alignas(64) float keys[3 * sweep_limit];
  const std::uint32_t candidates = 3 * count;
  for (std::uint32_t c = 0; c < candidates; c += width) hn::Store(hn::Set(lanes, infinity), lanes, keys + c);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      keys[axis * count + i] = doubled_centroid(references[i], static_cast<int>(axis));
    }
  }
  const Vec none = hn::Set(lanes, infinity), all = hn::Set(lanes, static_cast<float>(count));
  Vec best_cost = none, best_candidate = hn::Zero(lanes);
  for (std::uint32_t c = 0; c < candidates; c += width) {
    const Vec candidate = hn::Iota(lanes, static_cast<float>(c));
    const auto is_y = hn::Ge(candidate, all), is_z = hn::Ge(candidate, hn::Add(all, all));
    const Vec own_key = hn::Load(lanes, keys + c);
    Vec left_lower[3] = {none, none, none}, right_lower[3] = {none, none, none};
    Vec left_upper[3] = {hn::Neg(none), hn::Neg(none), hn::Neg(none)};
    Vec right_upper[3] = {hn::Neg(none), hn::Neg(none), hn::Neg(none)};
    Vec left_count = hn::Zero(lanes);
    for (std::uint32_t i = 0; i < count; ++i) {
      const float* const key = keys + i;
      const Vec key_on_axis =
          hn::IfThenElse(is_z, hn::Set(lanes, key[2 * count]),
                         hn::IfThenElse(is_y, hn::Set(lanes, key[count]), hn::Set(lanes, key[0])));
      const auto is_left = hn::Le(key_on_axis, own_key);
      left_count = hn::Add(left_count, hn::IfThenElseZero(is_left, hn::Set(lanes, 1.0f)));
      for (int k = 0; k < 3; ++k) {
        const Vec lower = hn::Set(lanes, (&references[i].lower.x)[k]);
        const Vec upper = hn::Set(lanes, (&references[i].upper.x)[k]);
        left_lower[k] = hn::Min(left_lower[k], hn::IfThenElse(is_left, lower, none));
        left_upper[k] = hn::Max(left_upper[k], hn::IfThenElse(is_left, upper, hn::Neg(none)));
        right_lower[k] = hn::Min(right_lower[k], hn::IfThenElse(is_left, none, lower));
        right_upper[k] = hn::Max(right_upper[k], hn::IfThenElse(is_left, hn::Neg(none), upper));
      }
    }
    const auto area = [](const Vec* lower, const Vec* upper) {
      const Vec x = hn::Sub(upper[0], lower[0]), y = hn::Sub(upper[1], lower[1]),
                z = hn::Sub(upper[2], lower[2]);
      return hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
    };
    const Vec cost = hn::Add(hn::Mul(area(left_lower, left_upper), left_count),
                             hn::Mul(area(right_lower, right_upper), hn::Sub(all, left_count)));
    const auto better = hn::Lt(cost, best_cost);  // false for not a number: nothing on the right
    best_cost = hn::IfThenElse(better, cost, best_cost);
    best_candidate = hn::IfThenElse(better, candidate, best_candidate);
  }
  // Of several that cost the same, the first candidate: the same one for any number of lanes.
  const Vec least = hn::MinOfLanes(lanes, best_cost);
  const Vec first = hn::MinOfLanes(lanes, hn::IfThenElse(hn::Eq(best_cost, least), best_candidate, none));
  const auto best = static_cast<std::uint32_t>(hn::GetLane(first));
  const int axis = (best >= count ? 1 : 0) + (best >= 2 * count ? 1 : 0);
  return {hn::GetLane(least), axis, 0.0f, 1.0f, next_above(keys[best])};
}

// Reorders in place without a branch: every reference is swapped to the border, which moves on past those
// that go left. Gives the children's counts and boxes.
struct Partition {
  std::uint32_t left_count;
  ChildBoxes boxes, centroids;
};

HWY_NOINLINE Partition partition(Reference* references, std::uint32_t count, const ObjectSplit& split) {
  Partition result{0, {empty_box(), empty_box()}, {empty_box(), empty_box()}};
  Reference* border = references;
  for (std::uint32_t i = 0; i < count; ++i) {
    const SimdBox box = load_box(references[i]), centroid = centroid_box(box);
    const float place = (doubled_centroid(references[i], split.axis) - split.origin) * split.scale;
    const BoxMask is_left = box_mask(place, split.threshold);
    result.boxes.left = merge_if(is_left, result.boxes.left, box);
    result.boxes.right = merge_if_not(is_left, result.boxes.right, box);
    result.centroids.left = merge_if(is_left, result.centroids.left, centroid);
    result.centroids.right = merge_if_not(is_left, result.centroids.right, centroid);
    const Reference here = references[i];
    references[i] = *border;
    *border = here;
    border += place < split.threshold ? 1 : 0;
  }
  result.left_count = static_cast<std::uint32_t>(border - references);
  return result;
}

// The same where nobody asks for the bounds of the centroids.
HWY_INLINE std::uint32_t partition_few(Reference* references, std::uint32_t count, const ObjectSplit& split,
                                       ChildBoxes& boxes) {
  boxes = {empty_box(), empty_box()};
  Reference* border = references;
  for (std::uint32_t i = 0; i < count; ++i) {
    const SimdBox box = load_box(references[i]);
    const float key = doubled_centroid(references[i], split.axis);
    const BoxMask is_left = box_mask(key, split.threshold);
    boxes.left = merge_if(is_left, boxes.left, box);
    boxes.right = merge_if_not(is_left, boxes.right, box);
    const Reference here = references[i];
    references[i] = *border;
    *border = here;
    border += key < split.threshold ? 1 : 0;
  }
  return static_cast<std::uint32_t>(border - references);
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif  // per target
