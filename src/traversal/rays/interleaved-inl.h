// Many rays by turns on one core.
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
// a mispredicted branch. Here a few rays are in flight, each with its own stack. Every round takes all that
// are at a node one step further, then all that are at a leaf. A step has no branch that depends on the ray:
// it pushes what it meets, pops the nearest, and puts the ray down in the list for a node or the list for a
// leaf; and what it needs next is on its way from memory while the others have their turn.
//
// When a hit comes nearer, all of a ray's stack is culled at once, so that pops need not look at t.
template <bool any_hit>
class Interleaved {
  static constexpr std::uint32_t width = 16;  // rays in flight

  struct Lane {
    WideRay ray;
    StoredNodeConstants node_constants;
    Hit best;
    std::size_t result;  // where the hit goes
    std::uint32_t link;
    std::size_t depth;
    Stack<1> stack;
  };

  // The lanes that are at a node, and those that are at a leaf or at the end; behind the last there is room
  // to write.
  struct Lists {
    std::uint32_t nodes = 0, leaves = 0;
    std::uint32_t at_node[width + 1], at_leaf[width + 1];
  };

 public:
  // Traces `rays[which[i]]` for each i below `count`.
  HWY_INLINE Interleaved(const WideBvh& bvh, const Ray* rays, const std::uint32_t* which, std::size_t count)
      : bvh_(bvh), rays_(rays), which_(which), count_(count) {}

  // `finish(which[i], hit)` is called once for each ray, in any order, and returns nothing; `single(ray)`
  // traces the few that are not fit for this.
  template <class Finish, class Single>
  HWY_INLINE void run(Finish&& finish, Single&& single) {
    Lists lists;
    for (std::uint32_t i = 0; i < width; ++i) start(i, lists, finish, single);
    while (lists.nodes + lists.leaves > 0) {
      const Lists turn = lists;
      lists.nodes = lists.leaves = 0;
      for (std::uint32_t i = 0; i < turn.nodes; ++i) step(turn.at_node[i], lists);
      for (std::uint32_t i = 0; i < turn.leaves; ++i) {
        const std::uint32_t number = turn.at_leaf[i];
        if (lanes_[number].link == Stack<1>::bottom) {
          finish(lanes_[number].result, lanes_[number].best);
          start(number, lists, finish, single);
        } else {
          test(number, lists);
        }
      }
    }
  }

 private:
  // Puts the next ray into the lane, if there is one.
  template <class Finish, class Single>
  HWY_INLINE void start(std::uint32_t number, Lists& lists, Finish&& finish, Single&& single) {
    Lane& lane = lanes_[number];
    while (next_ < count_) {
      const std::uint32_t i = which_[next_++];
      const Ray& ray = rays_[i];
      if (HWY_UNLIKELY(!set_up(ray, bvh_, lane.ray))) {
        finish(i, single(ray));
        continue;
      }
      lane.node_constants.set(lane.ray);
      lane.best = Hit{};
      if (!(ray.t_min <= ray.t_max)) {
        finish(i, lane.best);
        continue;
      }
      lane.best.t = std::min(ray.t_max, std::numeric_limits<float>::max());
      lane.result = i;
      lane.stack.link[0] = Stack<1>::bottom;
      lane.stack.t[0] = -std::numeric_limits<float>::infinity();
      lane.depth = 1;
      put_down(number, ChildLink::node(0).bits(), lists);
      return;
    }
  }

  HWY_INLINE void put_down(std::uint32_t number, std::uint32_t link, Lists& lists) {
    lanes_[number].link = link;
    const ChildLink child(link);
    const std::uint32_t leaf = child.is_leaf();
    lists.at_node[lists.nodes] = number;
    lists.at_leaf[lists.leaves] = number;
    lists.nodes += 1 - leaf;
    lists.leaves += leaf;
    const auto node_address =
        reinterpret_cast<std::uintptr_t>(bvh_.nodes.data()) + std::size_t{link} * sizeof(WideNode);
    const auto leaf_address =
        reinterpret_cast<std::uintptr_t>(bvh_.leaves.data() + words_per_triangle * child.first());
    // Written without a choice, for which compilers would put a branch that no machine predicts.
    const std::uintptr_t address =
        node_address ^ ((node_address ^ leaf_address) & (std::uintptr_t{0} - leaf));
    for (std::size_t line = 0; line < 8; ++line)
      hwy::Prefetch(reinterpret_cast<const char*>(address + 64 * line));
  }

  HWY_INLINE void step(std::uint32_t number, Lists& lists) {
    Lane& lane = lanes_[number];
    const WideNode& node = bvh_.nodes[lane.link];
    const Spans spans = meet_boxes(lane.node_constants, box_vector(lane.best.t), node);
    const std::size_t before = lane.depth;
    std::size_t depth = before;
    const std::uint32_t older = lane.stack.link[before - 1];
    std::uint32_t nearest;
    push_children<any_hit>(node, spans, lane.ray.octant, lane.stack, depth, nearest);
    lane.depth = depth - 1;
    put_down(number, depth > before ? nearest : older, lists);
  }

  HWY_INLINE void pop(std::uint32_t number, Lists& lists) {
    Lane& lane = lanes_[number];
    put_down(number, lane.stack.link[--lane.depth], lists);
  }

  HWY_INLINE void test(std::uint32_t number, Lists& lists) {
    Lane& lane = lanes_[number];
    const ChildLink leaf(lane.link);
    const LeafConstants constants(lane.ray);
    if (intersect_leaf<any_hit>(constants, bvh_, leaf, rays_[lane.result], lane.best)) {
      if constexpr (any_hit) {
        lane.depth = 1;
      } else {
        cull(lane);
      }
    }
    pop(number, lists);
  }

  // Takes what lies behind the hit off the stack.
  HWY_INLINE void cull(Lane& lane) {
    const FloatTag floats;
    const hn::RebindToUnsigned<FloatTag> integers;
    const auto t_best = hn::Set(floats, lane.best.t);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < lane.depth; i += hn::Lanes(floats)) {
      const auto t = hn::LoadU(floats, lane.stack.t + i);
      const auto link = hn::LoadU(integers, lane.stack.link + i);
      const auto keep = hn::And(hn::Le(t, t_best), hn::FirstN(floats, lane.depth - i));
      hn::StoreU(compress(t, keep), floats, lane.stack.t + kept);
      hn::StoreU(compress(link, keep), integers, lane.stack.link + kept);
      kept += hn::CountTrue(floats, keep);
    }
    lane.depth = kept;
  }

  const WideBvh& bvh_;
  const Ray* rays_;
  const std::uint32_t* which_;
  std::size_t count_;
  std::size_t next_ = 0;
  Lane lanes_[width];
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
