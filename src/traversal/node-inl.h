// The node that the target at hand traces, and one number for each of its slots.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_NODE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_NODE_INL_H
#undef KERF_TRAVERSAL_NODE_INL_H
#else
#define KERF_TRAVERSAL_NODE_INL_H
#endif

#include <hwy/highway.h>

#include "layout/wide_bvh.hpp"
#include "simd/floats-inl.h"
#include "simd/targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

inline constexpr std::uint32_t node_width = KERF_NODE_WIDTH;
using Node = WideNode<node_width>;
using NodeFloats = Floats<node_width>;

HWY_INLINE const Node& node_at(const WideBvh& bvh, std::uint32_t number) {
  return bvh.nodes<Node>()[number];
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
