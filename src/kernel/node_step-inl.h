// A ray against the eight boxes of a node. Included once per instruction set.

#if defined(KERF_NODE_STEP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_NODE_STEP_INL
#undef KERF_NODE_STEP_INL
#else
#define KERF_NODE_STEP_INL
#endif

#include <bit>

#include "kernel/eight_lanes-inl.h"
#include "kernel/wide_ray-inl.h"
#include "tree/binary_tree.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Open nodes and leaves, with the distance at which the ray enters them, for a traversal that takes up to
// `nodes_a_step` entries off the top at once. Children lie above what is not as deep, so that all entries of
// a depth came in one step: eight for each node of it, one of which at least has been taken since but at the
// greatest depth. Eight are written at a time.
template <std::size_t nodes_a_step>
struct Stack {
  static constexpr std::size_t capacity =
      (nodes_a_step * wide_node_children - 1) * max_tree_depth + 2 * wide_node_children;
  static constexpr std::uint32_t bottom =
      0xffffffffu;  // below the first entry: like a leaf, but no leaf has it
  std::uint32_t link[capacity];
  float t[capacity];
};

// Where the ray enters and leaves each of the boxes: it meets those with first <= last.
struct Spans {
  Eight first, last;
};

HWY_INLINE const Eight& eight(const Eight& a) {
  return a;
}
HWY_INLINE Eight eight(float a) {
  return broadcast(a);
}

template <class Constants>
HWY_INLINE Spans meet_boxes(const Constants& ray, const Eight& t_best, const WideNode& node) {
  const float* planes = &node.planes[0][0][0];
  const Eight inverse_x = eight(ray.inverse[0]), inverse_y = eight(ray.inverse[1]),
              inverse_z = eight(ray.inverse[2]);
  const Eight first_x = multiply_add(load(planes + ray.near[0]), inverse_x, eight(ray.enter[0]));
  const Eight first_y = multiply_add(load(planes + ray.near[1]), inverse_y, eight(ray.enter[1]));
  const Eight first_z = multiply_add(load(planes + ray.near[2]), inverse_z, eight(ray.enter[2]));
  const Eight last_x = multiply_add(load(planes + ray.far[0]), inverse_x, eight(ray.leave[0]));
  const Eight last_y = multiply_add(load(planes + ray.far[1]), inverse_y, eight(ray.leave[1]));
  const Eight last_z = multiply_add(load(planes + ray.far[2]), inverse_z, eight(ray.leave[2]));
  return {maximum(maximum(first_x, first_y), maximum(first_z, eight(ray.t_min))),
          minimum(minimum(last_x, last_y), minimum(last_z, t_best))};
}

// Pushes the children that are met, the nearest last (any_hit: the last slot last, and without t), and says
// which that is. `depth` grows by their number, which may be 0: then `nearest` means nothing.
template <bool any_hit, std::size_t nodes_a_step>
HWY_INLINE void push_children(const WideNode& node, const Spans& spans, std::uint32_t octant,
                              Stack<nodes_a_step>& stack, std::size_t& depth, std::uint32_t& nearest) {
  const std::uint32_t met = less_or_equal(spans.first, spans.last);
#if HWY_TARGET <= HWY_AVX2
  const FloatTag floats;
  const hn::RebindToUnsigned<FloatTag> integers;
  const auto links = hn::LoadU(integers, reinterpret_cast<const std::uint32_t*>(node.children));
  const auto first = spans.first.part[0], last = spans.last.part[0];
  if constexpr (any_hit) {
    hn::StoreU(compress(links, hn::Le(first, last)), integers, stack.link + depth);
    nearest = node.children[31 - std::countl_zero(met | 1)].bits();
  } else {
    alignas(32) static constexpr std::uint32_t far_to_near[8] = {21, 18, 15, 12, 9, 6, 3, 0};
    const auto order = hn::Set(integers, node.order[octant]);
    const auto slots = hn::And(hn::Shr(order, hn::Load(integers, far_to_near)), hn::Set(integers, 7u));
    const auto float_slots = hn::IndicesFromVec(floats, slots);
    const auto first_ordered = hn::TableLookupLanes(first, float_slots);
    const auto mask = hn::Le(first_ordered, hn::TableLookupLanes(last, float_slots));
    const auto links_ordered = hn::TableLookupLanes(links, hn::IndicesFromVec(integers, slots));
    hn::StoreU(compress(links_ordered, mask), integers, stack.link + depth);
    hn::StoreU(compress(first_ordered, mask), floats, stack.t + depth);
    const std::uint32_t ordered = bits(mask);
    const int place = std::countl_zero((ordered << 24) | (1u << 24));  // from near
    nearest = node.children[(node.order[octant] >> (3 * place)) & 7].bits();
  }
  depth += static_cast<std::size_t>(std::popcount(met));
#else
  alignas(32) float t[8];
  if constexpr (!any_hit) store(spans.first, t);
  for (std::uint32_t place = 0; place < wide_node_children; ++place) {
    const std::uint32_t slot = any_hit ? place : (node.order[octant] >> (3 * (7 - place))) & 7;
    stack.link[depth] = node.children[slot].bits();
    if constexpr (!any_hit) stack.t[depth] = t[slot];
    depth += (met >> slot) & 1;
  }
  nearest = stack.link[depth - 1];
#endif
}

#if HWY_TARGET <= HWY_AVX2
// Writes the slots of the children that are met, from far to near, and returns their number.
HWY_INLINE std::uint32_t far_to_near(const WideNode& node, const Spans& spans, std::uint32_t octant,
                                     std::uint32_t (&out)[wide_node_children]) {
  const FloatTag floats;
  const hn::RebindToUnsigned<FloatTag> integers;
  const auto first = spans.first.part[0], last = spans.last.part[0];
  alignas(32) static constexpr std::uint32_t from_far[8] = {21, 18, 15, 12, 9, 6, 3, 0};
  const auto order = hn::Set(integers, node.order[octant]);
  const auto slots = hn::And(hn::Shr(order, hn::Load(integers, from_far)), hn::Set(integers, 7u));
  const auto float_slots = hn::IndicesFromVec(floats, slots);
  const auto mask = hn::Le(hn::TableLookupLanes(first, float_slots), hn::TableLookupLanes(last, float_slots));
  hn::StoreU(compress(slots, mask), integers, out);
  return static_cast<std::uint32_t>(std::popcount(less_or_equal(spans.first, spans.last)));
}
#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
