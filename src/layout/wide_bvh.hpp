// The structure that rays are traced through: nodes of sixteen, eight or four children, and leaves of up to
// eight triangles that are tested together. Flat arrays without pointers, so that a file of them can be
// traced where it lies.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include <kerf/layout.hpp>

namespace kerf {

/// The largest width of a node.
inline constexpr std::uint32_t max_node_width = 16;
inline constexpr std::uint32_t wide_leaf_triangles = max_leaf_triangles;

/// The arrays, as `Layout` shows them, and what keeps their memory.
struct WideBvh {
  std::uint32_t width = max_node_width;  ///< of all nodes
  std::uint32_t node_count = 0;
  const void* node_data = nullptr;
  std::span<const std::uint32_t> leaves;
  Box3f bounds;
  float largest_coordinate = 0.0f;
  std::uint32_t depth = 0;

  std::shared_ptr<const void> node_memory, leaf_memory;  ///< keep what is shown above

  bool empty() const { return node_count == 0; }
  /// The nodes, `Node` being `WideNode<width>`.
  template <class Node>
  const Node* nodes() const {
    return static_cast<const Node*>(node_data);
  }
  std::size_t node_bytes() const { return node_count * (std::size_t{32} * width); }
  std::span<const std::byte> node_memory_view() const {
    return {static_cast<const std::byte*>(node_data), node_bytes()};
  }
  std::size_t references() const {
    return empty() ? 0 : (leaves.size() - leaf_padding_words) / words_per_triangle;
  }
};

/// Calls `call` with the constant `width`, which is 16, 8 or 4.
template <class Call>
auto with_width(std::uint32_t width, Call&& call) {
  if (width == 16) return call(std::integral_constant<std::uint32_t, 16>());
  if (width == 8) return call(std::integral_constant<std::uint32_t, 8>());
  return call(std::integral_constant<std::uint32_t, 4>());
}

/// What a hierarchy within `bounds` has as its `largest_coordinate`.
inline float largest_coordinate(const Box3f& bounds) {
  float largest = 0.0f;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max({largest, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
  return largest;
}

/// The nine rows of a leaf's coordinates, `leaf.count()` floats each.
inline const std::uint32_t* leaf_words(const WideBvh& bvh, ChildLink leaf) {
  return bvh.leaves.data() + words_per_triangle * leaf.first();
}
inline const float* leaf_rows(const WideBvh& bvh, ChildLink leaf) {
  return reinterpret_cast<const float*>(leaf_words(bvh, leaf));
}

/// Whether two triangles in leaves have the same corners, bit by bit.
bool same_corners(const WideBvh& bvh, ChildLink leaf, std::uint32_t i, ChildLink other, std::uint32_t j);

inline Triangle triangle_in(const WideBvh& bvh, ChildLink leaf, std::uint32_t i) {
  return triangle_in(bvh.leaves, leaf, i);
}
inline std::uint32_t triangle_id(const WideBvh& bvh, ChildLink leaf, std::uint32_t i) {
  return triangle_id(bvh.leaves, leaf, i);
}

/// Calls `visit(leaf)` for each leaf.
template <class Visit>
void for_each_leaf(const WideBvh& bvh, const Visit& visit) {
  with_width(bvh.width, [&](auto width) {
    for (const auto& node : std::span(bvh.nodes<WideNode<width>>(), bvh.node_count)) {
      for (std::uint32_t slot = 0; slot < width; ++slot) {
        const ChildLink child = node.children[slot];
        if (child.is_leaf() && !child_box(node, slot).empty()) visit(child);
      }
    }
  });
}

}  // namespace kerf
