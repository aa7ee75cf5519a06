// Object splits: every reference goes whole to one child.
// Included once for each instruction set: see subtree.cpp.

#if defined(KERF_BUILD_OBJECT_SPLIT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_BUILD_OBJECT_SPLIT_INL
#undef KERF_BUILD_OBJECT_SPLIT_INL
#else
#define KERF_BUILD_OBJECT_SPLIT_INL
#endif

#include <cstring>

#include "build/bins-inl.hpp"
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

// How a box finds its bins by its centroid.
struct ObjectBinner {
  Vec4 origin, scale, last;

  HWY_INLINE void find(const SimdBox& box, float* places) const {
    const Vec4 place = hn::Mul(hn::Sub(doubled_centroid(box), origin), scale);
    hn::Store(hn::Add(hn::Min(hn::Floor(place), last), hn::Set(four, bin_magic)), four, places);
  }
};

HWY_INLINE ObjectBinner object_binner(const BinMapping& mapping, int bin_count) {
  return {hn::Load(four, mapping.origin), hn::Load(four, mapping.scale),
          hn::Set(four, static_cast<float>(bin_count - 1))};
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
    hn::Store(half_areas(x, y, z), four, right_areas[i]);
  }
  x = y = z = empty_box();
  auto left = hn::Zero(four_ints);
  const Vec4 total = hn::Set(four, static_cast<float>(count));
  Vec4 best_cost = hn::Set(four, infinity), best_plane = hn::Zero(four);
  for (int i = 1; i < bin_count; ++i) {
    x = merge(x, bins.box(0, i - 1));
    y = merge(y, bins.box(1, i - 1));
    z = merge(z, bins.box(2, i - 1));
    left = hn::Add(left, bins.counts(i - 1));
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
HWY_INLINE ChildBoxes child_boxes(const Bins& bins, const ObjectSplit& split, int bin_count) {
  ChildBoxes boxes{empty_box(), empty_box()};
  const int plane = static_cast<int>(split.threshold);
  for (int i = 0; i < plane; ++i) boxes.left = merge(boxes.left, bins.box(split.axis, i));
  for (int i = plane; i < bin_count; ++i) boxes.right = merge(boxes.right, bins.box(split.axis, i));
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
  // A cost whose last bits are the candidate's number: the order of positive floats is that of their bits, so
  // that one minimum finds both, and of several that cost the same the first, for any number of lanes. The
  // bits lost are 2^-18 of the cost.
  using Bits = hn::RebindToUnsigned<Lanes>;
  constexpr Bits bits;
  const auto number_bits = hn::Set(bits, std::uint32_t{63});
  auto best = hn::Set(bits, ~std::uint32_t{0});
  static_assert(3 * sweep_limit <= 64);
  auto numbers = hn::Iota(bits, 0);
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
      // Chosen from what a lane has and what it would have, which AVX-512 does in one instruction.
      for (int k = 0; k < 3; ++k) {
        const Vec lower = hn::Set(lanes, (&references[i].lower.x)[k]);
        const Vec upper = hn::Set(lanes, (&references[i].upper.x)[k]);
        left_lower[k] = hn::IfThenElse(is_left, hn::Min(left_lower[k], lower), left_lower[k]);
        left_upper[k] = hn::IfThenElse(is_left, hn::Max(left_upper[k], upper), left_upper[k]);
        right_lower[k] = hn::IfThenElse(is_left, right_lower[k], hn::Min(right_lower[k], lower));
        right_upper[k] = hn::IfThenElse(is_left, right_upper[k], hn::Max(right_upper[k], upper));
      }
    }
    const auto area = [](const Vec* lower, const Vec* upper) {
      const Vec x = hn::Sub(upper[0], lower[0]), y = hn::Sub(upper[1], lower[1]),
                z = hn::Sub(upper[2], lower[2]);
      return hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
    };
    const Vec cost = hn::Add(hn::Mul(area(left_lower, left_upper), left_count),
                             hn::Mul(area(right_lower, right_upper), hn::Sub(all, left_count)));
    const auto numbered = hn::Or(hn::AndNot(number_bits, hn::BitCast(bits, cost)), numbers);
    numbers = hn::Add(numbers, hn::Set(bits, width));
    // Where nothing is on the right the cost is not a number.
    const auto valid = hn::RebindMask(bits, hn::Lt(left_count, all));
    best = hn::Min(best, hn::IfThenElse(valid, numbered, hn::Set(bits, ~std::uint32_t{0})));
  }
  const std::uint32_t least = hn::GetLane(hn::MinOfLanes(bits, best));
  if (least == ~std::uint32_t{0}) return {};
  const std::uint32_t candidate = least & 63, cost_bits = least & ~std::uint32_t{63};
  ObjectSplit split;
  std::memcpy(&split.cost, &cost_bits, sizeof split.cost);
  split.axis = (candidate >= count ? 1 : 0) + (candidate >= 2 * count ? 1 : 0);
  split.threshold = next_above(keys[candidate]);
  return split;
}

// Which side references go to, and what each side encloses.
struct Sides {
  ChildBoxes boxes;
  ChildBoxes centroids;

  HWY_INLINE bool add(const Reference& reference, const ObjectSplit& split) {
    const SimdBox box = load_box(reference), centroid = centroid_box(box);
    const float place = (doubled_centroid(reference, split.axis) - split.origin) * split.scale;
    const BoxMask is_left = box_mask(place, split.threshold);
    boxes.left = merge_if(is_left, boxes.left, box);
    boxes.right = merge_if_not(is_left, boxes.right, box);
    centroids.left = merge_if(is_left, centroids.left, centroid);
    centroids.right = merge_if_not(is_left, centroids.right, centroid);
    return place < split.threshold;
  }
};

// Few references: those that go right wait in a buffer. Without a branch: each is written to both sides, and
// the one where it belongs moves on.
constexpr std::uint32_t buffered_limit = 256;

HWY_INLINE std::uint32_t partition_buffered(Reference* references, std::uint32_t count,
                                            const ObjectSplit& split, Sides& sides) {
  alignas(32) std::byte memory[buffered_limit * sizeof(Reference)];
  auto* const right = reinterpret_cast<Reference*>(memory);
  std::uint32_t left_count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool is_left = sides.add(references[i], split);
    const SimdBox here = load_whole(references[i]);
    store_whole(here, right[i - left_count]);
    store_whole(here, references[left_count]);
    left_count += is_left ? 1 : 0;
  }
  std::copy_n(right, count - left_count, references + left_count);
  return left_count;
}

// Many references: those on the wrong side are listed, a block from either end at a time, and exchanged in
// pairs (Edelkamp & Weiss 2016, "BlockQuicksort").
HWY_INLINE std::uint32_t partition_in_blocks(Reference* references, std::uint32_t count,
                                             const ObjectSplit& split, Sides& sides) {
  constexpr std::uint32_t block = 128;
  std::uint8_t wrong_left[block], wrong_right[block];
  std::uint32_t begin = 0, end = count, left_first = 0, left_last = 0, right_first = 0, right_last = 0;
  while (end - begin > 2 * block) {
    if (left_first == left_last) {
      left_first = left_last = 0;
      for (std::uint32_t i = 0; i < block; ++i) {
        wrong_left[left_last] = static_cast<std::uint8_t>(i);
        left_last += sides.add(references[begin + i], split) ? 0 : 1;
      }
    }
    if (right_first == right_last) {
      right_first = right_last = 0;
      for (std::uint32_t i = 0; i < block; ++i) {
        wrong_right[right_last] = static_cast<std::uint8_t>(i);
        right_last += sides.add(references[end - 1 - i], split) ? 1 : 0;
      }
    }
    const std::uint32_t pairs = std::min(left_last - left_first, right_last - right_first);
    for (std::uint32_t i = 0; i < pairs; ++i) {
      exchange(references[begin + wrong_left[left_first + i]],
               references[end - 1 - wrong_right[right_first + i]]);
    }
    left_first += pairs;
    right_first += pairs;
    if (left_first == left_last) begin += block;
    if (right_first == right_last) end -= block;
  }
  // At most one of the two blocks was left half done: whom it still lists must not be counted twice, which a
  // minimum does not mind.
  return begin + partition_buffered(references + begin, end - begin, split, sides);
}

// Reorders in place: those that go left come first.
struct Partition {
  std::uint32_t left_count;
  ChildBoxes boxes, centroids;
};

HWY_NOINLINE Partition partition(Reference* references, std::uint32_t count, const ObjectSplit& split) {
  Sides sides{{empty_box(), empty_box()}, {empty_box(), empty_box()}};
  const std::uint32_t left_count = count <= buffered_limit
                                       ? partition_buffered(references, count, split, sides)
                                       : partition_in_blocks(references, count, split, sides);
  return {left_count, sides.boxes, sides.centroids};
}

// The same for no more than `sweep_limit`, where nobody asks for the bounds of the centroids.
HWY_INLINE std::uint32_t partition_few(Reference* references, std::uint32_t count, const ObjectSplit& split,
                                       ChildBoxes& boxes) {
  boxes = {empty_box(), empty_box()};
  alignas(32) std::byte memory[sweep_limit * sizeof(Reference)];
  auto* const right = reinterpret_cast<Reference*>(memory);
  std::uint32_t left_count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const SimdBox box = load_box(references[i]);
    const float key = doubled_centroid(references[i], split.axis);
    const BoxMask is_left = box_mask(key, split.threshold);
    boxes.left = merge_if(is_left, boxes.left, box);
    boxes.right = merge_if_not(is_left, boxes.right, box);
    const SimdBox here = load_whole(references[i]);
    store_whole(here, right[i - left_count]);
    store_whole(here, references[left_count]);
    left_count += key < split.threshold ? 1 : 0;
  }
  std::copy_n(right, count - left_count, references + left_count);
  return left_count;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif  // per target
