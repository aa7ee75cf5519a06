// The structure that rays are traced through: nodes of sixteen children, and leaves of up to eight triangles
// that are tested together. Flat arrays without pointers, so that a file of them can be traced where it lies.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <kerf/layout.hpp>

namespace kerf {

inline constexpr std::uint32_t wide_node_children = WideNode::width;
inline constexpr std::uint32_t wide_leaf_triangles = max_leaf_triangles;

/// The arrays, as `Layout` shows them, and what keeps their memory.
struct WideBvh {
  std::span<const WideNode> nodes;
  std::span<const std::uint32_t> leaves;
  Box3f bounds;
  float largest_coordinate = 0.0f;
  std::uint32_t depth = 0;

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

/// The nine rows of a leaf's coordinates, `leaf.count()` floats each.
inline const float* leaf_rows(const WideBvh& bvh, ChildLink leaf) {
  return reinterpret_cast<const float*>(bvh.leaves.data() + words_per_triangle * leaf.first());
}

inline Triangle triangle_in(const WideBvh& bvh, ChildLink leaf, std::uint32_t i) {
  return triangle_in(bvh.leaves, leaf, i);
}
inline std::uint32_t triangle_id(const WideBvh& bvh, ChildLink leaf, std::uint32_t i) {
  return triangle_id(bvh.leaves, leaf, i);
}

}  // namespace kerf
