// The cheapest object split of all, for few references.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_OBJECT_SWEEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_OBJECT_SWEEP_INL_H
#undef KERF_CONSTRUCTION_SBVH_OBJECT_SWEEP_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_OBJECT_SWEEP_INL_H
#endif

#include <cstring>

#include <hwy/highway.h>

#include "construction/sbvh/object_split-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// Up to this many references, every split between neighbouring centroids is tried.
constexpr std::uint32_t sweep_limit = 16;

// The smallest float above x.
HWY_INLINE float next_above(float x) {
  if (x == 0.0f) return std::numeric_limits<float>::denorm_min();
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits += x > 0.0f ? 1u : ~0u;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

// A split has the number of the reference on its left that is farthest along its axis, the first of several,
// plus the axis times the number of references. Of splits that cost the same, the lowest number is taken: it
// replaces the last bits of the cost. Positive floats are ordered as their bits are, so that one minimum
// finds both. The bits lost are 2^-18 of the cost.
constexpr std::uint32_t number_mask = 63, no_split = ~std::uint32_t{0};
static_assert(3 * sweep_limit <= number_mask + 1);

// The split with these bits; `key(axis, i)` is the doubled centroid of a reference.
template <class Key>
HWY_INLINE ObjectSplit to_split(std::uint32_t numbered, std::uint32_t count, const Key& key) {
  if (numbered == no_split) return {};
  const std::uint32_t number = numbered & number_mask, cost_bits = numbered & ~number_mask;
  ObjectSplit split;
  std::memcpy(&split.cost, &cost_bits, sizeof split.cost);
  split.axis = (number >= count ? 1 : 0) + (number >= 2 * count ? 1 : 0);
  split.threshold = next_above(key(split.axis, number - static_cast<std::uint32_t>(split.axis) * count));
  return split;
}

#if KERF_FLOAT_LANES == 16
// Tries every split between neighbouring centroids, without sorting. Each lane is one candidate: a reference
// and an axis. It sends left the references that lie no farther along the axis than its own. All lanes see
// one reference after another.
HWY_NOINLINE ObjectSplit sweep(const Reference* references, std::uint32_t count) {
  using Lanes = hn::CappedTag<float, 16>;
  constexpr Lanes lanes;
  using Vec = hn::Vec<Lanes>;
  constexpr std::uint32_t width = hn::MaxLanes(Lanes());
  static_assert(3 * sweep_limit % width == 0);

  // keys[axis * count + i] is candidate i of an axis. The candidates behind the last send all references
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
  using Bits = hn::RebindToUnsigned<Lanes>;
  constexpr Bits bits;
  const auto number_bits = hn::Set(bits, number_mask);
  auto best = hn::Set(bits, no_split);
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
      // AVX-512 does a minimum and its selection in one masked instruction.
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
    // Where no reference is on the right, the cost is not a number.
    const auto valid = hn::RebindMask(bits, hn::Lt(left_count, all));
    best = hn::Min(best, hn::IfThenElse(valid, numbered, hn::Set(bits, no_split)));
  }
  return to_split(hn::GetLane(hn::MinOfLanes(bits, best)), count, [&](int axis, std::uint32_t i) {
    return keys[static_cast<std::uint32_t>(axis) * count + i];
  });
}
#else

// The places of references in the order of their doubled centroids along the axes, one axis per lane.
struct SweepOrder {
  alignas(16) float keys[sweep_limit][4];
  alignas(16) std::uint32_t numbers[sweep_limit][4];
};

HWY_INLINE void transpose(Float4 (&rows)[4]) {
  const Float4 xy02 = hn::InterleaveLower(f32x4, rows[0], rows[2]),
               xy13 = hn::InterleaveLower(f32x4, rows[1], rows[3]),
               z02 = hn::InterleaveUpper(f32x4, rows[0], rows[2]),
               z13 = hn::InterleaveUpper(f32x4, rows[1], rows[3]);
  rows[0] = hn::InterleaveLower(f32x4, xy02, xy13);
  rows[1] = hn::InterleaveUpper(f32x4, xy02, xy13);
  rows[2] = hn::InterleaveLower(f32x4, z02, z13);
}

// A reference's place is the number of those before it. Of equal keys, the one with the lower number comes
// first.
HWY_INLINE void sort(const float (&keys)[3][sweep_limit], std::uint32_t count, SweepOrder& order) {
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    alignas(16) std::int32_t places[sweep_limit];
    for (std::uint32_t first = 0; first < count; first += 4) {
      const Float4 own = hn::Load(f32x4, keys[axis] + first);
      auto place = hn::Zero(i32x4);
      const auto count_if = [&](hn::Mask<FloatTag4> is_before) HWY_ATTR {
        place = hn::Sub(place, hn::BitCast(i32x4, hn::VecFromMask(f32x4, is_before)));
      };
      std::uint32_t i = 0;
      for (; i < first; ++i) count_if(hn::Le(hn::Set(f32x4, keys[axis][i]), own));
      for (; i < HWY_MIN(first + 4, count); ++i) {
        const Float4 key = hn::Set(f32x4, keys[axis][i]);
        const auto is_later = hn::Not(hn::FirstN(f32x4, i - first + 1));
        count_if(hn::Or(hn::Lt(key, own), hn::And(is_later, hn::Eq(key, own))));
      }
      for (; i < count; ++i) count_if(hn::Lt(hn::Set(f32x4, keys[axis][i]), own));
      hn::Store(place, i32x4, places + first);
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      order.keys[places[i]][axis] = keys[axis][i];
      order.numbers[places[i]][axis] = i;
    }
  }
}

// Tries every split between neighbouring centroids: along sorted references, on three axes at a time.
HWY_NOINLINE ObjectSplit sweep(const Reference* references, std::uint32_t count) {
  SimdBox boxes[sweep_limit];
  alignas(16) float keys[3][sweep_limit];
  for (std::uint32_t first = 0; first < count; first += 4) {
    Float4 rows[4];
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t index = HWY_MIN(first + i, count - 1);
      boxes[index] = load_box(references[index]);
      rows[i] = doubled_centroid(boxes[index]);
    }
    transpose(rows);
    for (std::uint32_t axis = 0; axis < 3; ++axis) hn::Store(rows[axis], f32x4, keys[axis] + first);
  }
  SweepOrder order;
  for (std::uint32_t i = 0; i < count; ++i) order.keys[i][3] = 0.0f, order.numbers[i][3] = 0;
  sort(keys, count, order);

  const auto box_at = [&](std::uint32_t place, int axis) { return boxes[order.numbers[place][axis]]; };
  alignas(16) float right_areas[sweep_limit][4];
  SimdBox x = empty_box(), y = x, z = x;
  for (std::uint32_t i = count - 1; i > 0; --i) {
    x = merge(x, box_at(i, 0));
    y = merge(y, box_at(i, 1));
    z = merge(z, box_at(i, 2));
    hn::Store(half_areas(x, y, z), f32x4, right_areas[i - 1]);
  }
  x = y = z = empty_box();
  alignas(16) const std::uint32_t first_numbers[4] = {0, count, 2 * count, 0};
  const auto axis_offset = hn::Load(u32x4, first_numbers);
  auto best = hn::Set(u32x4, no_split), number = hn::Zero(u32x4);
  const Float4 all = hn::Set(f32x4, static_cast<float>(count));
  Float4 left_count = hn::Zero(f32x4);
  Float4 key = hn::Load(f32x4, order.keys[0]), key_before = hn::Set(f32x4, -infinity);
  for (std::uint32_t i = 0; i + 1 < count; ++i) {
    x = merge(x, box_at(i, 0));
    y = merge(y, box_at(i, 1));
    z = merge(z, box_at(i, 2));
    left_count = hn::Add(left_count, hn::Set(f32x4, 1.0f));
    const Float4 cost = hn::Add(hn::Mul(half_areas(x, y, z), left_count),
                                hn::Mul(hn::Load(f32x4, right_areas[i]), hn::Sub(all, left_count)));
    number = hn::IfThenElse(hn::RebindMask(u32x4, hn::Lt(key_before, key)),
                            hn::Add(hn::Load(u32x4, order.numbers[i]), axis_offset), number);
    const Float4 next_key = hn::Load(f32x4, order.keys[i + 1]);
    const auto numbered = hn::Or(hn::AndNot(hn::Set(u32x4, number_mask), hn::BitCast(u32x4, cost)), number);
    const auto valid = hn::RebindMask(u32x4, hn::Lt(key, next_key));
    best = hn::Min(best, hn::IfThenElse(valid, numbered, hn::Set(u32x4, no_split)));
    key_before = key;
    key = next_key;
  }
  return to_split(hn::GetLane(hn::MinOfLanes(u32x4, best)), count,
                  [&](int axis, std::uint32_t i) { return keys[axis][i]; });
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
