// What every builder makes, and what measures, refinement, the wide layout and the files read.
#pragma once

#include <cstddef>
#include <cstdint>

#include <kerf/tree.hpp>

#include "base/uninitialized.hpp"
#include "math/box3f.hpp"

namespace kerf {

/// The maximum depth of a leaf; that of the root is 0. Near it every builder takes median splits, so that a
/// stack of this many entries is enough for any traversal. Halving 2^32 references takes 32 of these levels.
/// The others are for the surface-area heuristic: sponza's tree has a depth of 30, a dragon's of 34.
inline constexpr std::uint32_t max_tree_depth = 96;

/// A binary bounding volume hierarchy. `nodes[0]` is the root; a tree of nothing has no nodes.
struct BinaryTree {
  UninitializedVector<BinaryNode> nodes;
  UninitializedVector<std::uint32_t>
      references;                        ///< the triangles of the leaves, by their number in the `Geometry`
  std::size_t degenerate_triangles = 0;  ///< left out by the builder
  std::size_t non_finite_triangles = 0;  ///< left out, too, see `BuildOptions::non_finite`

  /// Triangles were divided only in nodes of at least this many references: below a node of fewer, no
  /// triangle has two references. 0 where this is not known.
  std::uint32_t min_divided_count = 0;

  /// How often each node is expected to be visited, where the rays to come are known; else none, and half the
  /// area of its box stands for it.
  UninitializedVector<float> visits = {};
  std::size_t build_peak_bytes = 0;  ///< the maximum that the builder held, this tree included

  bool empty() const { return nodes.empty(); }

  /// The memory of the arrays.
  std::size_t bytes() const {
    return nodes.capacity() * sizeof(BinaryNode) + references.capacity() * sizeof(std::uint32_t) +
           visits.capacity() * sizeof(float);
  }
};

/// The maximum memory of a tree of so many references: every leaf has one.
constexpr std::size_t binary_tree_bytes(std::size_t references) {
  return references * (2 * sizeof(BinaryNode) + sizeof(std::uint32_t));
}

}  // namespace kerf
