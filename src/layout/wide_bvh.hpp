// The structure that rays are traced through: nodes of sixteen children, and leaves of up to eight triangles
// that are tested together. Flat arrays without pointers, so that a file of them can be traced where it lies.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <kerf/vec.hpp>

#include "math/triangle.hpp"

namespace kerf {

inline constexpr std::uint32_t wide_node_children = 16;
inline constexpr std::uint32_t wide_leaf_triangles = 8;

/// Names a node, or a leaf:
///
///     bit 31   30..28      27..0
///     0        number of the node
///     1        count - 1   place of the leaf's first triangle
class ChildLink {
 public:
  static constexpr std::uint32_t place_bits = 28;
  static constexpr std::uint32_t max_place = (1u << place_bits) - 1;

  constexpr ChildLink() = default;
  constexpr explicit ChildLink(std::uint32_t bits) : bits_(bits) {}
  static constexpr ChildLink node(std::uint32_t number) { return ChildLink(number); }
  static constexpr ChildLink leaf(std::uint32_t first, std::uint32_t count) {
    return ChildLink((1u << 31) | ((count - 1) << place_bits) | first);
  }

  constexpr bool is_leaf() const { return (bits_ >> 31) != 0; }
  constexpr std::uint32_t node() const { return bits_; }
  constexpr std::uint32_t first() const { return bits_ & max_place; }
  constexpr std::uint32_t count() const { return ((bits_ >> place_bits) & 7u) + 1; }
  constexpr std::uint32_t bits() const { return bits_; }

 private:
  std::uint32_t bits_ = 0;
};

/// Eight cache lines, one a row of planes. Children fill the slots from 0 up; an unused slot has an empty
/// box, and names the leaf at place 0.
struct alignas(64) WideNode {
  float planes[3][2][wide_node_children];  ///< [axis][lower, upper][child]
  ChildLink children[wide_node_children];

  /// For each octant of directions (bit a set: negative along axis a), the slots from near to far, four bits
  /// each, nearest lowest (after Fuetterling et al. 2017, "Accelerated Single Ray Tracing for Wide Vector
  /// Units").
  std::uint64_t order[8];
};
static_assert(sizeof(WideNode) == 512);

/// A leaf of n triangles is ten rows of n words: x, y, z of the first vertices, of the second, of the third,
/// then the triangles' numbers. Leaves lie side by side, so that leaf data of k triangles begin at word 10 k.
inline constexpr std::size_t words_per_triangle = 10;

/// Rows are read eight words at a time; behind the last leaf lie this many words that mean nothing.
inline constexpr std::size_t leaf_padding_words = 16;

struct WideBvh {
  std::span<const WideNode> nodes;        ///< nodes[0] is the root; none for a hierarchy of nothing
  std::span<const std::uint32_t> leaves;  ///< words_per_triangle * (triangles in leaves) + leaf_padding_words
  Box3f bounds;
  float largest_coordinate = 0.0f;  ///< of `bounds`
  std::uint32_t depth = 0;          ///< the most nodes on a way from the root to a leaf

  std::shared_ptr<const void> node_memory, leaf_memory;  ///< keep what the spans show

  bool empty() const { return nodes.empty(); }
  std::size_t references() const {
    return empty() ? 0 : (leaves.size() - leaf_padding_words) / words_per_triangle;
  }
};

/// What a hierarchy within `bounds` has as its `largest_coordinate`.
inline float largest_coordinate(const Box3f& bounds) {
  float largest = 0.0f;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max({largest, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
  return largest;
}

/// The box of a child; empty for an unused slot.
inline Box3f child_box(const WideNode& node, std::uint32_t slot) {
  Box3f box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = node.planes[axis][0][slot];
    box.upper[axis] = node.planes[axis][1][slot];
  }
  return box;
}

/// The nine rows of a leaf's coordinates, `leaf.count()` floats each.
inline const float* leaf_rows(const WideBvh& bvh, ChildLink leaf) {
  return reinterpret_cast<const float*>(bvh.leaves.data() + words_per_triangle * leaf.first());
}

/// Triangle `i` of the leaf, `0 <= i < leaf.count()`.
inline Triangle triangle_in(const WideBvh& bvh, ChildLink leaf, std::uint32_t i) {
  const std::uint32_t* word = bvh.leaves.data() + words_per_triangle * leaf.first() + i;
  Triangle triangle;
  for (Vec3f* vertex : {&triangle.v0, &triangle.v1, &triangle.v2}) {
    for (int axis = 0; axis < 3; ++axis, word += leaf.count()) (*vertex)[axis] = std::bit_cast<float>(*word);
  }
  return triangle;
}

/// The number of that triangle in the `Geometry`.
inline std::uint32_t triangle_id(const WideBvh& bvh, ChildLink leaf, std::uint32_t i) {
  return bvh.leaves[words_per_triangle * leaf.first() + 9 * leaf.count() + i];
}

}  // namespace kerf
