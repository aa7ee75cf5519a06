// A tree of eight children in 80 bytes, after Ylitie, Karras & Laine 2017 ("Efficient Incoherent Ray
// Traversal on GPUs Through Compressed Wide BVHs").
#pragma once

#include <vector>

#include "../src/binary_layout.hpp"
#include "../src/source_tree.hpp"

namespace kerf::cuda {

/// Planes are `origin + plane * 2^(exponent - 127)`, rounded outward.
struct alignas(16) CompressedNode {
  float origin[3];
  std::uint8_t exponent[3];
  std::uint8_t inner;  // bit i: child i is a node
  std::uint32_t first_node, first_triangle;
  std::uint8_t kind[8];      // 0: no child; 1: a node; else a leaf, see below
  std::uint8_t plane[6][8];  // lower x, upper x, lower y, upper y, lower z, upper z, of each child
};
static_assert(sizeof(CompressedNode) == 80);

/// The nodes below a node follow one another in the order of the children, and so do its triangles.
inline constexpr std::uint32_t wide_leaf_bit = 0x80, max_wide_leaf = 4;
KERF_CUDA_INLINE std::uint8_t wide_leaf(std::uint32_t offset, std::uint32_t count) {
  return static_cast<std::uint8_t>(wide_leaf_bit | ((count - 1) << 5) | offset);
}
KERF_CUDA_INLINE std::uint32_t wide_leaf_offset(std::uint32_t kind) {
  return kind & 31;
}
KERF_CUDA_INLINE std::uint32_t wide_leaf_count(std::uint32_t kind) {
  return ((kind >> 5) & 3) + 1;
}

struct WideHierarchy {
  const CompressedNode* nodes;  // node 0 is the root; none for a hierarchy of nothing
  const DeviceTriangle* triangles;
  const SceneBounds* bounds;
  std::uint32_t node_count;
};

struct EncodedWide {
  std::vector<CompressedNode> nodes;
  std::vector<DeviceTriangle> triangles;
  SceneBounds bounds;
};

/// The tree's nodes, those of the largest area first, joined to nodes of up to eight children.
EncodedWide encode_wide(const SourceTree& tree);

}  // namespace kerf::cuda
