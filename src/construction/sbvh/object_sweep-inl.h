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
  // The last bits of a cost are replaced by the candidate's number. Positive floats are ordered as their bits
  // are, so that one minimum finds both, and the first of several that cost the same, for any number of
  // lanes. The bits lost are 2^-18 of the cost.
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
    best = hn::Min(best, hn::IfThenElse(valid, numbered, hn::Set(bits, ~std::uint32_t{0})));
  }
  const std::uint32_t lowest = hn::GetLane(hn::MinOfLanes(bits, best));
  if (lowest == ~std::uint32_t{0}) return {};
  const std::uint32_t candidate = lowest & 63, cost_bits = lowest & ~std::uint32_t{63};
  ObjectSplit split;
  std::memcpy(&split.cost, &cost_bits, sizeof split.cost);
  split.axis = (candidate >= count ? 1 : 0) + (candidate >= 2 * count ? 1 : 0);
  split.threshold = next_above(keys[candidate]);
  return split;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
