// What every builder makes, and what measures, refinement, the wide layout and the files read.
#pragma once

#include <cstddef>
#include <cstdint>

#include <kerf/tree.hpp>

#include "base/uninitialized.hpp"
#include "math/box3f.hpp"

namespace kerf {

/// No leaf lies deeper than this below the root, whose depth is 0: every builder ends in median splits when
/// it comes near, so a stack of this many entries is enough for any traversal. 32 of these levels suffice to
/// halve 2^32 references; the surface-area heuristic has the others to itself (sponza's tree is 30 deep, a
/// dragon's 34).
inline constexpr std::uint32_t max_tree_depth = 96;

/// A binary bounding volume hierarchy. `nodes[0]` is the root; a tree of nothing has no nodes.
struct BinaryTree {
  UninitializedVector<BinaryNode> nodes;
  UninitializedVector<std::uint32_t>
      references;                        ///< the triangles of the leaves, by their number in the `Geometry`
  std::size_t degenerate_triangles = 0;  ///< left out by the builder

  /// Triangles were divided only where a node had at least this many references: below a node of fewer, none
  /// stands twice. 0 where nothing is known.
  std::uint32_t least_divided = 0;
  std::size_t build_peak_bytes = 0;  ///< the most that the builder held at once, this tree included

  bool empty() const { return nodes.empty(); }

  /// What it takes.
  std::size_t bytes() const {
    return nodes.capacity() * sizeof(BinaryNode) + references.capacity() * sizeof(std::uint32_t);
  }
};

/// The most that a tree of so many references takes: one leaf for each.
constexpr std::size_t binary_tree_bytes(std::size_t references) {
  return references * (2 * sizeof(BinaryNode) + sizeof(std::uint32_t));
}

}  // namespace kerf
