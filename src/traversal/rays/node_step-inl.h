// A ray and the boxes of a node.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_NODE_STEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_NODE_STEP_INL_H
#undef KERF_TRAVERSAL_RAYS_NODE_STEP_INL_H
#else
#define KERF_TRAVERSAL_RAYS_NODE_STEP_INL_H
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include <hwy/highway.h>
#include <kerf/counters.hpp>

#include "simd/compress-inl.h"
#include "simd/floats-inl.h"
#include "simd/lookup-inl.h"
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
// in one step, as many for each of its nodes as that has slots. Except at the maximum depth, at least one of
// them has been taken since. As many entries are written at a time.
template <std::size_t nodes_per_step>
struct Stack {
  static constexpr std::size_t capacity = (nodes_per_step * node_width - 1) * max_tree_depth + 2 * node_width;
  static constexpr std::uint32_t bottom =
      0xffffffffu;  // below the first entry: looks like a leaf, but no leaf has this link
  std::uint32_t link[capacity];
  float t[capacity];
};

// Where the ray enters and leaves each box. It meets those with first <= last.
struct Spans {
  NodeFloats first, last;
};

HWY_INLINE BoxVector box_vector(BoxVector a) {
  return a;
}
HWY_INLINE BoxVector box_vector(float a) {
  return hn::Set(NodeFloats::Tag(), a);
}

// Bit i says whether the ray meets box i. `forward`: see `meet_boxes`.
template <bool forward>
HWY_INLINE std::uint32_t boxes_met(const Spans& spans) {
#if KERF_FLOAT_LANES < 16
  if constexpr (forward) {  // as integers, in one cycle in place of four
    const NodeFloats::Tag floats;
    const hn::RebindToSigned<NodeFloats::Tag> integers;
    std::uint32_t missed = 0;
    for (std::size_t i = 0; i < NodeFloats::vectors; ++i) {
      const auto behind =
          hn::Gt(hn::BitCast(integers, spans.first.vector[i]), hn::BitCast(integers, spans.last.vector[i]));
      missed |= bits(floats, hn::RebindMask(floats, behind)) << (i * NodeFloats::lanes);
    }
    return missed ^ ((1u << node_width) - 1);
  }
#endif
  return less_or_equal(spans.first, spans.last);
}

// `forward`: t_min is not negative, nor is -0. Then neither is where the ray enters a box, and a negative end
// of its span, whatever its size, says that the box is missed.
template <bool forward, class Constants>
HWY_INLINE Spans meet_boxes(const Constants& ray, BoxVector t_best, const Node& node) {
  const BoxVector inverse_x = box_vector(ray.inverse[0]), inverse_y = box_vector(ray.inverse[1]),
                  inverse_z = box_vector(ray.inverse[2]);
  const auto& rows = rows_of(ray);
  Spans spans;
  for (std::size_t i = 0; i < NodeFloats::vectors; ++i) {
    const char* planes = reinterpret_cast<const char*>(&node.planes[0][0][0] + i * NodeFloats::lanes);
    const auto at = [planes](std::size_t row) HWY_ATTR {
      return hn::LoadU(NodeFloats::Tag(), reinterpret_cast<const float*>(planes + row));
    };
    const BoxVector first_x = hn::MulAdd(at(rows.near[0]), inverse_x, box_vector(ray.enter[0]));
    const BoxVector first_y = hn::MulAdd(at(rows.near[1]), inverse_y, box_vector(ray.enter[1]));
    const BoxVector first_z = hn::MulAdd(at(rows.near[2]), inverse_z, box_vector(ray.enter[2]));
    const BoxVector last_x = hn::MulAdd(at(rows.far[0]), inverse_x, box_vector(ray.leave[0]));
    const BoxVector last_y = hn::MulAdd(at(rows.far[1]), inverse_y, box_vector(ray.leave[1]));
    const BoxVector last_z = hn::MulAdd(at(rows.far[2]), inverse_z, box_vector(ray.leave[2]));
    const BoxVector t_min = box_vector(ray.t_min);
    if constexpr (forward) {
      spans.first.vector[i] =
          larger_as_bits(larger_as_bits(first_x, first_y), larger_as_bits(first_z, t_min));
      spans.last.vector[i] =
          smaller_as_bits(smaller_as_bits(last_x, last_y), smaller_as_bits(last_z, t_best));
    } else {
      spans.first.vector[i] = hn::Max(hn::Max(first_x, first_y), hn::Max(first_z, t_min));
      spans.last.vector[i] = hn::Min(hn::Min(last_x, last_y), hn::Min(last_z, t_best));
    }
  }
  return spans;
}

#if KERF_FLOAT_LANES == KERF_NODE_WIDTH && KERF_NODE_WIDTH >= 8
// The slots from far to near.
HWY_INLINE auto far_to_near_slots(const Node& node, std::uint32_t octant) {
  const hn::RebindToUnsigned<NodeFloats::Tag> integers;
  alignas(64) static constexpr std::uint32_t shifts[16] = {28, 24, 20, 16, 12, 8, 4, 0,
                                                           28, 24, 20, 16, 12, 8, 4, 0};
  const std::uint64_t order = node.order[octant];
  auto words = hn::Set(integers, static_cast<std::uint32_t>(order));
#if KERF_NODE_WIDTH == 16
  const auto farther = hn::Set(integers, static_cast<std::uint32_t>(order >> 32));
  words = hn::IfThenElse(hn::FirstN(integers, 8), farther, words);
#endif
  return hn::And(hn::Shr(words, hn::Load(integers, shifts)), hn::Set(integers, 15u));
}
#endif

#if KERF_FLOAT_LANES == 4 && KERF_NODE_WIDTH == 4
// Which bytes of four words a shuffle takes.
struct alignas(16) WordShuffle {
  std::uint8_t byte[16];
};
constexpr WordShuffle shuffle_of(const std::array<std::uint32_t, 4>& words) {
  WordShuffle shuffle{};
  for (std::uint32_t i = 0; i < 16; ++i)
    shuffle.byte[i] = static_cast<std::uint8_t>(4 * words[i / 4] + i % 4);
  return shuffle;
}
// By the order of a node: its slots from far to near.
constexpr std::array<WordShuffle, 256> far_to_near_words = [] {
  std::array<WordShuffle, 256> table{};
  for (std::uint32_t order = 0; order < 256; ++order)
    table[order] = shuffle_of({order >> 6, (order >> 4) & 3, (order >> 2) & 3, order & 3});
  return table;
}();
// By a set of words: these, moved to the front.
constexpr std::array<WordShuffle, 16> front_words = [] {
  std::array<WordShuffle, 16> table{};
  for (std::uint32_t set = 0; set < 16; ++set) {
    std::array<std::uint32_t, 4> words{};
    std::uint32_t count = 0;
    for (std::uint32_t word = 0; word < 4; ++word) {
      if (set >> word & 1) words[count++] = word;
    }
    table[set] = shuffle_of(words);
  }
  return table;
}();
#endif

// Pushes the children in `met`, the nearest last, and returns it in `nearest`; for `any_hit`, the last
// slot last, and without t. `depth` grows by their number. If that is 0, `nearest` means nothing.
template <bool any_hit, std::size_t nodes_per_step>
HWY_INLINE void push_children(const Node& node, const Spans& spans, std::uint32_t met, std::uint32_t octant,
                              Stack<nodes_per_step>& stack, std::size_t& depth, std::uint32_t& nearest) {
#if KERF_FLOAT_LANES == KERF_NODE_WIDTH && KERF_NODE_WIDTH >= 8
  const NodeFloats::Tag floats;
  const hn::RebindToUnsigned<NodeFloats::Tag> integers;
  const auto links = hn::LoadU(integers, reinterpret_cast<const std::uint32_t*>(node.children));
  const auto first = spans.first.vector[0], last = spans.last.vector[0];
  if constexpr (any_hit) {
#if KERF_FLOAT_LANES == 8
    hn::StoreU(compress_set(links, met), integers, stack.link + depth);
#else
    hn::StoreU(compress(links, hn::Le(first, last)), integers, stack.link + depth);
#endif
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
    constexpr std::uint32_t above = 32 - node_width;
    const int place = std::countl_zero((ordered << above) | (1u << above));  // from near
    nearest = node.children[(node.order[octant] >> (4 * place)) & 15].bits();
  }
  depth += static_cast<std::size_t>(std::popcount(met));
#elif KERF_FLOAT_LANES == 4 && KERF_NODE_WIDTH == 4
  const NodeFloats::Tag floats;
  const hn::RebindToUnsigned<NodeFloats::Tag> integers;
  const auto links = hn::LoadU(integers, reinterpret_cast<const std::uint32_t*>(node.children));
  if constexpr (any_hit) {
    hn::StoreU(lookup_bytes(links, front_words[met].byte), integers, stack.link + depth);
  } else {
    const WordShuffle& order = far_to_near_words[node.order[octant]];
    const auto first = lookup_bytes(spans.first.vector[0], order.byte),
               last = lookup_bytes(spans.last.vector[0], order.byte);
    const WordShuffle& front = front_words[bits(floats, hn::Le(first, last))];
    hn::StoreU(lookup_bytes(lookup_bytes(links, order.byte), front.byte), integers, stack.link + depth);
    hn::StoreU(lookup_bytes(first, front.byte), floats, stack.t + depth);
  }
  depth += static_cast<std::size_t>(std::popcount(met));
  nearest = stack.link[depth == 0 ? 0 : depth - 1];
#else
  // Every slot is written where the next one belongs, and stays if it is met: no branch depends on the ray.
  if constexpr (any_hit) {
    for (std::uint32_t slot = 0; slot < node_width; ++slot) {
      stack.link[depth] = node.children[slot].bits();
      depth += (met >> slot) & 1;
    }
  } else {
    alignas(64) float t[node_width];
    store(spans.first, t);
    const std::uint64_t order = node.order[octant];
    for (std::uint32_t place = node_width; place-- > 0;) {
      const auto slot = static_cast<std::uint32_t>(order >> (Node::slot_bits * place)) & (node_width - 1);
      stack.link[depth] = node.children[slot].bits();
      stack.t[depth] = t[slot];
      depth += (met >> slot) & 1;
    }
  }
  nearest = stack.link[depth == 0 ? 0 : depth - 1];
#endif
}

// Takes up to `max_nodes` nodes off the stack and pushes their children.
template <bool any_hit, bool counting, bool forward, std::size_t max_nodes, class Stack>
HWY_INLINE void step_next(const WideBvh& bvh, const NodeConstants& constants, std::uint32_t octant,
                          BoxVector t_best, float best_t, Stack& stack, std::size_t& depth,
                          TraversalCounters* counters) {
  if constexpr (max_nodes > 0) {
    const ChildLink next(stack.link[depth - 1]);
    if (next.is_leaf() | (!any_hit && stack.t[depth - 1] > best_t)) return;
    --depth;
    if constexpr (counting) ++counters->steps;
    const Node& node = node_at(bvh, next.node());
    const Spans spans = meet_boxes<forward>(constants, t_best, node);
    step_next<any_hit, counting, forward, max_nodes - 1>(bvh, constants, octant, t_best, best_t, stack, depth,
                                                         counters);
    std::uint32_t nearest;
    push_children<any_hit>(node, spans, boxes_met<forward>(spans), octant, stack, depth, nearest);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
