#include "layout/wide_children.hpp"

#include <algorithm>

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "layout/wide_children.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

constexpr std::uint32_t octants = 8;

// The place of a slot in the order of an octant is the number of slots before it. Distances are those of half
// the centers, so that the sum of three coordinates stays finite.
#if KERF_FLOAT_LANES >= 8
namespace hn = hwy::HWY_NAMESPACE;
using FloatTag8 = hn::FixedTag<float, 8>;
using IntTag8 = hn::FixedTag<std::int32_t, 8>;
using Row = hn::Vec<FloatTag8>;
constexpr FloatTag8 f32x8;
constexpr IntTag8 i32x8;

// For eight children, one per lane: rows 0 to 5 are the coordinates of the lower and the upper corners.
HWY_INLINE void transpose(const BinaryNode* const* children, Row* rows) {
  Row in[8], pairs[8], fours[8];
  for (int i = 0; i < 8; ++i) in[i] = hn::LoadU(f32x8, &children[i]->bounds.lower.x);
  for (int i = 0; i < 8; i += 2) {
    pairs[i] = hn::InterleaveLower(f32x8, in[i], in[i + 1]);
    pairs[i + 1] = hn::InterleaveUpper(f32x8, in[i], in[i + 1]);
  }
  constexpr hn::Repartition<double, FloatTag8> doubles;
  const auto lower = [&](Row a, Row b) {
    return hn::BitCast(f32x8, hn::InterleaveLower(doubles, hn::BitCast(doubles, a), hn::BitCast(doubles, b)));
  };
  const auto upper = [&](Row a, Row b) {
    return hn::BitCast(f32x8, hn::InterleaveUpper(doubles, hn::BitCast(doubles, a), hn::BitCast(doubles, b)));
  };
  for (int i = 0; i < 8; i += 4) {
    fours[i] = lower(pairs[i], pairs[i + 2]);
    fours[i + 1] = upper(pairs[i], pairs[i + 2]);
    fours[i + 2] = lower(pairs[i + 1], pairs[i + 3]);
    fours[i + 3] = upper(pairs[i + 1], pairs[i + 3]);
  }
  for (int i = 0; i < 4; ++i) rows[i] = hn::ConcatLowerLower(f32x8, fours[i + 4], fours[i]);
  for (int i = 0; i < 2; ++i) rows[i + 4] = hn::ConcatUpperUpper(f32x8, fours[i + 4], fours[i]);
}

// One octant per lane.
template <std::uint32_t slots>
HWY_INLINE void write_in_vectors(const BinaryNode* const* children, std::uint32_t count,
                                 WideNode<slots>& node) {
  alignas(32) float centers[3][slots];
  for (std::uint32_t first = 0; first < slots; first += 8) {
    Row rows[6];
    transpose(children + first, rows);
    for (int axis = 0; axis < 3; ++axis) {
      hn::Store(rows[axis], f32x8, node.planes[axis][0] + first);
      hn::Store(rows[axis + 3], f32x8, node.planes[axis][1] + first);
      const Row quarter = hn::Set(f32x8, 0.25f);
      hn::Store(hn::Add(hn::Mul(rows[axis], quarter), hn::Mul(rows[axis + 3], quarter)), f32x8,
                centers[axis] + first);
    }
  }
  const auto octant = hn::Iota(i32x8, 0);
  const auto sign = [&](auto bit) { return hn::BitCast(f32x8, hn::ShiftLeft<31>(bit)); };
  const Row sign_x = sign(octant), sign_y = sign(hn::ShiftRight<1>(octant)),
            sign_z = sign(hn::ShiftRight<2>(octant));
  Row distances[slots];
  hn::Vec<IntTag8> places[slots];
  const auto one = hn::Set(i32x8, 1);
  for (std::uint32_t high = 0; high < count; ++high) {
    distances[high] = hn::Add(hn::Add(hn::Xor(hn::Set(f32x8, centers[0][high]), sign_x),
                                      hn::Xor(hn::Set(f32x8, centers[1][high]), sign_y)),
                              hn::Xor(hn::Set(f32x8, centers[2][high]), sign_z));
    auto place = hn::Set(i32x8, static_cast<std::int32_t>(high));
    for (std::uint32_t low = 0; low < high; ++low) {
      const auto high_first = hn::RebindMask(i32x8, hn::Lt(distances[high], distances[low]));
      const auto step = hn::IfThenElseZero(high_first, one);
      places[low] = hn::Add(places[low], step);
      place = hn::Sub(place, step);
    }
    places[high] = place;
  }
  // The nearest eight slots are in the lower half of an order.
  auto nearer = hn::Zero(i32x8), farther = hn::Zero(i32x8);
  for (std::uint32_t slot = 0; slot < slots; ++slot) {
    const auto index = hn::Set(i32x8, static_cast<std::int32_t>(slot));
    const auto place = slot < count ? places[slot] : index;
    const auto in_half = hn::And(place, hn::Set(i32x8, 7));
    const auto nibble = hn::Shl(index, hn::ShiftLeft<2>(in_half));
    const auto is_near = hn::Eq(in_half, place);
    nearer = hn::Or(nearer, hn::IfThenElseZero(is_near, nibble));
    farther = hn::Or(farther, hn::IfThenZeroElse(is_near, nibble));
  }
  alignas(32) std::uint32_t halves[2][octants];
  hn::Store(nearer, i32x8, reinterpret_cast<std::int32_t*>(halves[0]));
  hn::Store(farther, i32x8, reinterpret_cast<std::int32_t*>(halves[1]));
  for (std::uint32_t octant = 0; octant < octants; ++octant) {
    node.order[octant] = static_cast<typename WideNode<slots>::Order>(std::uint64_t{halves[1][octant]} << 32 |
                                                                      halves[0][octant]);
  }
}
#endif

template <std::uint32_t slots>
HWY_INLINE void write_one_by_one(const BinaryNode* const* children, std::uint32_t count,
                                 WideNode<slots>& node) {
  float distances[slots][octants];
  for (std::uint32_t slot = 0; slot < slots; ++slot) {
    const Box3f& box = children[slot]->bounds;
    for (int axis = 0; axis < 3; ++axis) {
      node.planes[axis][0][slot] = box.lower[axis];
      node.planes[axis][1][slot] = box.upper[axis];
    }
    if (slot >= count) continue;
    const Vec3f center = box.lower * 0.25f + box.upper * 0.25f;
    for (std::uint32_t octant = 0; octant < octants; ++octant) {
      distances[slot][octant] = (octant & 1 ? -center.x : center.x) + (octant & 2 ? -center.y : center.y) +
                                (octant & 4 ? -center.z : center.z);
    }
  }
  std::uint32_t places[slots][octants];
  for (std::uint32_t slot = 0; slot < slots; ++slot)
    std::fill_n(places[slot], octants, slot < count ? 0u : slot);
  for (std::uint32_t high = 1; high < count; ++high) {
    for (std::uint32_t low = 0; low < high; ++low) {
      for (std::uint32_t octant = 0; octant < octants; ++octant) {
        const std::uint32_t high_first = distances[high][octant] < distances[low][octant] ? 1 : 0;
        places[low][octant] += high_first;
        places[high][octant] += 1 - high_first;
      }
    }
  }
  for (std::uint32_t octant = 0; octant < octants; ++octant) {
    std::uint64_t order = 0;
    for (std::uint32_t slot = 0; slot < slots; ++slot)
      order |= std::uint64_t{slot} << (WideNode<slots>::slot_bits * places[slot][octant]);
    node.order[octant] = static_cast<typename WideNode<slots>::Order>(order);
  }
}

void write_children_16(const BinaryNode* const* children, std::uint32_t count, WideNode<16>& node) {
#if KERF_FLOAT_LANES >= 8
  write_in_vectors<16>(children, count, node);
#else
  write_one_by_one<16>(children, count, node);
#endif
}
void write_children_8(const BinaryNode* const* children, std::uint32_t count, WideNode<8>& node) {
#if KERF_FLOAT_LANES >= 8
  write_in_vectors<8>(children, count, node);
#else
  write_one_by_one<8>(children, count, node);
#endif
}
void write_children_4(const BinaryNode* const* children, std::uint32_t count, WideNode<4>& node) {
  write_one_by_one<4>(children, count, node);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(write_children_16);
HWY_EXPORT(write_children_8);
HWY_EXPORT(write_children_4);

template <std::uint32_t width>
void write_children(Target target, const BinaryNode* const* children, std::uint32_t count,
                    WideNode<width>& node) {
  static constexpr BinaryNode unused;
  const BinaryNode* in_slots[width];
  std::fill(std::copy_n(children, count, in_slots), in_slots + width, &unused);
  if constexpr (width == 16) KERF_DISPATCH(write_children_16, target)(in_slots, count, node);
  if constexpr (width == 8) KERF_DISPATCH(write_children_8, target)(in_slots, count, node);
  if constexpr (width == 4) KERF_DISPATCH(write_children_4, target)(in_slots, count, node);
}

template void write_children(Target, const BinaryNode* const*, std::uint32_t, WideNode<16>&);
template void write_children(Target, const BinaryNode* const*, std::uint32_t, WideNode<8>&);
template void write_children(Target, const BinaryNode* const*, std::uint32_t, WideNode<4>&);

}  // namespace kerf
#endif
