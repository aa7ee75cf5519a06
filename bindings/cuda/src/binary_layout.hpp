// The binary tree as the kernels of Aila & Laine 2009 ("Understanding the Efficiency of Ray Traversal on
// GPUs") read it: a node holds the boxes of both its children.
#pragma once

#include "triangle_test.hpp"

namespace kerf::cuda {

//   0 .. 15   lower x, upper x, lower y, upper y of the first child
//  16 .. 31   the same of the second
//  32 .. 47   lower z, upper z of the first, lower z, upper z of the second
//  48 .. 63   links of the two; number of the parent, `no_link` for the root's; 0, which refitting counts
//  with
struct alignas(64) PairNode {
  float first_xy[4], second_xy[4], z[4];
  std::uint32_t link[2], parent, arrived;
};
static_assert(sizeof(PairNode) == 64);

/// A link: the number of a node; or with bit 31 set a leaf, bits 28 to 30 the number of its triangles less
/// one, bits 0 to 27 its first triangle.
inline constexpr std::uint32_t leaf_bit = 0x80000000u;
KERF_CUDA_INLINE std::uint32_t leaf_link(std::uint32_t first, std::uint32_t count) {
  return leaf_bit | ((count - 1) << 28) | first;
}
KERF_CUDA_INLINE std::uint32_t leaf_count(std::uint32_t link) {
  return ((link >> 28) & 7) + 1;
}
KERF_CUDA_INLINE std::uint32_t leaf_first(std::uint32_t link) {
  return link & 0x0fffffffu;
}
/// Stands at the bottom of every stack.
inline constexpr std::uint32_t no_link = 0x7fffffffu;

struct BinaryHierarchy {
  const PairNode* nodes;  // node 0 is the root; none for a hierarchy of nothing
  const DeviceTriangle* triangles;
  const SceneBounds* bounds;
  std::uint32_t node_count;
};

}  // namespace kerf::cuda
