// Many rays in flight, interleaved on one core.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_INTERLEAVED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_INTERLEAVED_INL_H
#undef KERF_TRAVERSAL_RAYS_INTERLEAVED_INL_H
#else
#define KERF_TRAVERSAL_RAYS_INTERLEAVED_INL_H
#endif

#include <algorithm>
#include <cstdint>
#include <limits>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "simd/compress-inl.h"
#include "simd/floats-inl.h"
#include "traversal/rays/leaf_test-inl.h"
#include "traversal/rays/node_step-inl.h"
#include "traversal/rays/wide_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// A single ray spends most of its time waiting: for a node from memory, for a mask to become an address, for
// a mispredicted branch. Here several rays are in flight, each with its own stack. Every round takes all rays
// that are at a node one step further, then all that are at a leaf. A step has no branch that depends on the
// ray: it pushes the children that it meets, pops the nearest, and enters the ray into the list for nodes or
// the list for leaves. What the ray needs next is prefetched while the others take their steps.
//
// When a nearer hit is found, the whole stack of the ray is culled at once, so that pops need not compare t.
template <bool any_hit>
class Interleaved {
  static constexpr std::uint32_t width = 16;  // rays in flight

  struct RayState {
    WideRay ray;
    Nearest best;
    std::size_t result;  // where the hit goes
    std::uint32_t link;
    std::size_t depth;
    Stack<1> stack;
  };

  // The rays that are at a node, and those that are at a leaf or at the end of their stack. Behind the last
  // there is room for one more to be written.
  struct Lists {
    std::uint32_t nodes = 0, leaves = 0;
    std::uint32_t at_node[width + 1], at_leaf[width + 1];
  };

 public:
  // Traces `rays[which[i]]` for each i below `count`.
  HWY_INLINE Interleaved(const WideBvh& bvh, const Ray* rays, const std::uint32_t* which, std::size_t count)
      : bvh_(bvh), rays_(rays), which_(which), count_(count) {}

  // `finish(which[i], hit)` is called once per ray, in any order. `scale(ray)` traces the few rays that have
  // to be scaled.
  template <class Finish, class Scale>
  HWY_INLINE void run(Finish&& finish, Scale&& scale) {
    Lists lists;
    for (std::uint32_t i = 0; i < width; ++i) start(i, lists, finish, scale);
    while (lists.nodes + lists.leaves > 0) {
      const Lists round = lists;
      lists.nodes = lists.leaves = 0;
      for (std::uint32_t i = 0; i < round.nodes; ++i) step(round.at_node[i], lists);
      for (std::uint32_t i = 0; i < round.leaves; ++i) {
        const std::uint32_t index = round.at_leaf[i];
        if (states_[index].link == Stack<1>::bottom) {
          const RayState& state = states_[index];
          finish(state.result, any_hit ? Hit{.primitive = state.best.primitive}
                                       : settled_hit(bvh_, rays_[state.result], state.best));
          start(index, lists, finish, scale);
        } else {
          test(index, lists);
        }
      }
    }
  }

 private:
  // Starts the next ray in this place, if there is one.
  template <class Finish, class Scale>
  HWY_INLINE void start(std::uint32_t index, Lists& lists, Finish&& finish, Scale&& scale) {
    RayState& state = states_[index];
    while (next_ < count_) {
      const std::uint32_t i = which_[next_++];
      const Ray& ray = rays_[i];
      if (HWY_UNLIKELY(!set_up_forward(ray, bvh_, state.ray))) {
        finish(i, scale(ray));
        continue;
      }
      if (!(ray.t_min <= ray.t_max)) {
        finish(i, Hit{});
        continue;
      }
      state.best = Nearest(std::min(ray.t_max, std::numeric_limits<float>::max()));
      state.result = i;
      state.stack.link[0] = Stack<1>::bottom;
      state.stack.t[0] = -std::numeric_limits<float>::infinity();
      state.depth = 1;
      enlist(index, ChildLink::node(0).bits(), lists);
      return;
    }
  }

  HWY_INLINE void enlist(std::uint32_t index, std::uint32_t link, Lists& lists) {
    states_[index].link = link;
    const ChildLink child(link);
    const std::uint32_t leaf = child.is_leaf();
    lists.at_node[lists.nodes] = index;
    lists.at_leaf[lists.leaves] = index;
    lists.nodes += 1 - leaf;
    lists.leaves += leaf;
    const auto node_address =
        reinterpret_cast<std::uintptr_t>(bvh_.node_data) + std::size_t{link} * sizeof(Node);
    const auto leaf_address =
        reinterpret_cast<std::uintptr_t>(bvh_.leaves.data() + words_per_triangle * child.first());
    // Without ?:, which compilers translate to a branch that no machine predicts.
    const std::uintptr_t address =
        node_address ^ ((node_address ^ leaf_address) & (std::uintptr_t{0} - leaf));
    for (std::size_t line = 0; line < 8; ++line)
      hwy::Prefetch(reinterpret_cast<const char*>(address + 64 * line));
  }

  HWY_INLINE void step(std::uint32_t index, Lists& lists) {
    RayState& state = states_[index];
    const Node& node = node_at(bvh_, state.link);
    const Spans spans = meet_boxes<true>(state.ray, box_vector(state.best.last), node);
    const std::size_t before = state.depth;
    std::size_t depth = before;
    const std::uint32_t older = state.stack.link[before - 1];
    std::uint32_t nearest;
    push_children<any_hit>(node, spans, boxes_met<true>(spans), state.ray.octant, state.stack, depth,
                           nearest);
    state.depth = depth - 1;
    enlist(index, depth > before ? nearest : older, lists);
  }

  HWY_INLINE void pop(std::uint32_t index, Lists& lists) {
    RayState& state = states_[index];
    enlist(index, state.stack.link[--state.depth], lists);
  }

  HWY_INLINE void test(std::uint32_t index, Lists& lists) {
    RayState& state = states_[index];
    const ChildLink leaf(state.link);
    const LeafConstants constants(state.ray);
    if (intersect_leaf<any_hit>(constants, bvh_, leaf, rays_[state.result], state.best)) {
      if constexpr (any_hit) {
        state.depth = 1;
      } else {
        cull(state);
      }
    }
    pop(index, lists);
  }

  // Removes what lies behind the hit from the stack.
  HWY_INLINE void cull(RayState& state) {
    const FloatTag floats;
    const hn::RebindToUnsigned<FloatTag> integers;
    const auto t_best = hn::Set(floats, state.best.last);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < state.depth; i += hn::Lanes(floats)) {
      const auto t = hn::LoadU(floats, state.stack.t + i);
      const auto link = hn::LoadU(integers, state.stack.link + i);
      const auto keep = hn::And(hn::Le(t, t_best), hn::FirstN(floats, state.depth - i));
      hn::StoreU(compress(t, keep), floats, state.stack.t + kept);
      hn::StoreU(compress(link, keep), integers, state.stack.link + kept);
      kept += hn::CountTrue(floats, keep);
    }
    state.depth = kept;
  }

  const WideBvh& bvh_;
  const Ray* rays_;
  const std::uint32_t* which_;
  std::size_t count_;
  std::size_t next_ = 0;
  RayState states_[width];
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
