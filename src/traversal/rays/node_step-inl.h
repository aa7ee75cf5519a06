// A ray and the sixteen boxes of a node.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_NODE_STEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_NODE_STEP_INL_H
#undef KERF_TRAVERSAL_RAYS_NODE_STEP_INL_H
#else
#define KERF_TRAVERSAL_RAYS_NODE_STEP_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cstring>

#include <hwy/highway.h>

#include "simd/compress-inl.h"
#include "simd/floats-inl.h"
#include "simd/targets.hpp"
#include "traversal/rays/wide_ray-inl.h"
#include "tree/binary_tree.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Open nodes and leaves, with the distances at which the ray enters them, for a traversal that takes up to
// `nodes_per_step` entries off the top at once.
//
// Its capacity: children lie above everything that is less deep, so that all entries of a depth were pushed
// in one step, sixteen for each of its nodes. Except at the maximum depth, at least one of them has been
// taken since. Sixteen entries are written at a time.
template <std::size_t nodes_per_step>
struct Stack {
  static constexpr std::size_t capacity =
      (nodes_per_step * wide_node_children - 1) * max_tree_depth + 2 * wide_node_children;
  static constexpr std::uint32_t bottom =
      0xffffffffu;  // below the first entry: looks like a leaf, but no leaf has this link
  std::uint32_t link[capacity];
  float t[capacity];
};

// Where the ray enters and leaves each box. It meets those with first <= last.
struct Spans {
  Float16 first, last;
};

HWY_INLINE BoxVector box_vector(BoxVector a) {
  return a;
}
HWY_INLINE BoxVector box_vector(float a) {
  return hn::Set(Float16::Tag(), a);
}

template <class Constants>
HWY_INLINE Spans meet_boxes(const Constants& ray, BoxVector t_best, const WideNode& node) {
  const BoxVector inverse_x = box_vector(ray.inverse[0]), inverse_y = box_vector(ray.inverse[1]),
                  inverse_z = box_vector(ray.inverse[2]);
  Spans spans;
  for (std::size_t i = 0; i < Float16::vectors; ++i) {
    const float* planes = &node.planes[0][0][0] + i * Float16::lanes;
    const auto at = [planes](std::uint32_t row) HWY_ATTR { return hn::LoadU(Float16::Tag(), planes + row); };
    const BoxVector first_x = hn::MulAdd(at(ray.near[0]), inverse_x, box_vector(ray.enter[0]));
    const BoxVector first_y = hn::MulAdd(at(ray.near[1]), inverse_y, box_vector(ray.enter[1]));
    const BoxVector first_z = hn::MulAdd(at(ray.near[2]), inverse_z, box_vector(ray.enter[2]));
    const BoxVector last_x = hn::MulAdd(at(ray.far[0]), inverse_x, box_vector(ray.leave[0]));
    const BoxVector last_y = hn::MulAdd(at(ray.far[1]), inverse_y, box_vector(ray.leave[1]));
    const BoxVector last_z = hn::MulAdd(at(ray.far[2]), inverse_z, box_vector(ray.leave[2]));
    spans.first.vector[i] = hn::Max(hn::Max(first_x, first_y), hn::Max(first_z, box_vector(ray.t_min)));
    spans.last.vector[i] = hn::Min(hn::Min(last_x, last_y), hn::Min(last_z, t_best));
  }
  return spans;
}

#if KERF_FLOAT_LANES == 16
// The slots from far to near.
HWY_INLINE auto far_to_near_slots(const WideNode& node, std::uint32_t octant) {
  const hn::RebindToUnsigned<Float16::Tag> integers;
  alignas(64) static constexpr std::uint32_t shifts[16] = {28, 24, 20, 16, 12, 8, 4, 0,
                                                           28, 24, 20, 16, 12, 8, 4, 0};
  const std::uint64_t order = node.order[octant];
  const auto nearer = hn::Set(integers, static_cast<std::uint32_t>(order));
  const auto farther = hn::Set(integers, static_cast<std::uint32_t>(order >> 32));
  const auto words = hn::IfThenElse(hn::FirstN(integers, 8), farther, nearer);
  return hn::And(hn::Shr(words, hn::Load(integers, shifts)), hn::Set(integers, 15u));
}
#else
// The slots that are met, and room behind them: eight are written at a time.
struct MetSlots {
  alignas(16) std::uint8_t slot[wide_node_children + 8] = {};
};

// In ascending order.
HWY_INLINE void list_met(std::uint32_t met, MetSlots& to) {
#if KERF_FLOAT_LANES == 1
  std::size_t end = 0;
  for (std::uint32_t rest = met; rest != 0; rest &= rest - 1)
    to.slot[end++] = static_cast<std::uint8_t>(std::countr_zero(rest));
#else
  std::uint64_t lower, upper;
  std::memcpy(&lower, front_lanes.lane[met & 255], 8);
  std::memcpy(&upper, front_lanes.lane[met >> 8], 8);
  upper += 0x0808080808080808u;
  std::memcpy(to.slot, &lower, 8);
  std::memcpy(to.slot + std::popcount(met & 255), &upper, 8);
#endif
}

// From far to near.
HWY_INLINE void list_met(std::uint32_t met, std::uint64_t order, MetSlots& to) {
#if KERF_FLOAT_LANES == 1
  std::size_t end = 0;
  for (int place = 15; place >= 0; --place) {
    to.slot[end] = static_cast<std::uint8_t>((order >> (4 * place)) & 15);
    end += (met >> to.slot[end]) & 1;
  }
#else
  const hn::FixedTag<std::uint8_t, 16> bytes;
  const hn::FixedTag<std::uint64_t, 2> words;
  alignas(16) static constexpr std::uint8_t backwards[16] = {15, 14, 13, 12, 11, 10, 9, 8,
                                                             7,  6,  5,  4,  3,  2,  1, 0};
  const auto packed = hn::Set(words, order), four_bits = hn::Set(words, 0x0f0f0f0f0f0f0f0fu);
  const auto even = hn::BitCast(bytes, hn::And(packed, four_bits));
  const auto odd = hn::BitCast(bytes, hn::And(hn::ShiftRight<4>(packed), four_bits));
  const auto slots = hn::TableLookupBytes(hn::InterleaveLower(even, odd), hn::Load(bytes, backwards));
  alignas(8) std::uint8_t in_slots[8] = {static_cast<std::uint8_t>(met), static_cast<std::uint8_t>(met >> 8)};
  const auto is_met = hn::VecFromMask(bytes, hn::LoadMaskBits(bytes, in_slots));
  alignas(8) std::uint8_t in_order[8] = {};
  hn::StoreMaskBits(bytes, hn::MaskFromVec(hn::TableLookupBytes(is_met, slots)), in_order);
  const hn::Half<decltype(bytes)> half;
  const auto farther = hn::LoadU(half, front_lanes.lane[in_order[0]]);
  const auto nearer = hn::Add(hn::LoadU(half, front_lanes.lane[in_order[1]]), hn::Set(half, 8));
  const auto sorted = hn::TableLookupBytes(slots, hn::Combine(bytes, nearer, farther));
  hn::StoreU(hn::LowerHalf(half, sorted), half, to.slot);
  hn::StoreU(hn::UpperHalf(half, sorted), half, to.slot + std::popcount(unsigned{in_order[0]}));
#endif
}
#endif

// Pushes the children that are met, the nearest last, and returns it in `nearest`; for `any_hit`, the last
// slot last, and without t. `depth` grows by their number. If that is 0, `nearest` means nothing.
template <bool any_hit, std::size_t nodes_per_step>
HWY_INLINE void push_children(const WideNode& node, const Spans& spans, std::uint32_t octant,
                              Stack<nodes_per_step>& stack, std::size_t& depth, std::uint32_t& nearest) {
  const std::uint32_t met = less_or_equal(spans.first, spans.last);
#if KERF_FLOAT_LANES == 16
  const Float16::Tag floats;
  const hn::RebindToUnsigned<Float16::Tag> integers;
  const auto links = hn::LoadU(integers, reinterpret_cast<const std::uint32_t*>(node.children));
  const auto first = spans.first.vector[0], last = spans.last.vector[0];
  if constexpr (any_hit) {
    hn::StoreU(compress(links, hn::Le(first, last)), integers, stack.link + depth);
    nearest = node.children[31 - std::countl_zero(met | 1)].bits();
  } else {
    const auto slots = far_to_near_slots(node, octant);
    const auto float_slots = hn::IndicesFromVec(floats, slots);
    const auto first_ordered = hn::TableLookupLanes(first, float_slots);
    const auto mask = hn::Le(first_ordered, hn::TableLookupLanes(last, float_slots));
    const auto links_ordered = hn::TableLookupLanes(links, hn::IndicesFromVec(integers, slots));
    hn::StoreU(compress(links_ordered, mask), integers, stack.link + depth);
    hn::StoreU(compress(first_ordered, mask), floats, stack.t + depth);
    const std::uint32_t ordered = bits(floats, mask);
    const int place = std::countl_zero((ordered << 16) | (1u << 16));  // from near
    nearest = node.children[(node.order[octant] >> (4 * place)) & 15].bits();
  }
  depth += static_cast<std::size_t>(std::popcount(met));
#else
  alignas(64) float t[wide_node_children];
  MetSlots slots;
  if constexpr (any_hit) {
    list_met(met, slots);
  } else {
    store(spans.first, t);
    list_met(met, node.order[octant], slots);
  }
  const auto push = [&](std::size_t i) HWY_ATTR {
    stack.link[depth + i] = node.children[slots.slot[i]].bits();
    if constexpr (!any_hit) stack.t[depth + i] = t[slots.slot[i]];
  };
  const auto count = static_cast<std::size_t>(std::popcount(met));
  for (std::size_t i = 0; i < 4; ++i) push(i);  // more are rare
  for (std::size_t i = 4; i < count; ++i) push(i);
  depth += count;
  nearest = stack.link[depth - 1];
#endif
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
