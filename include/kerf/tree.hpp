// The binary tree that a builder makes, before it becomes the structure that is traced.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <kerf/export.hpp>
#include <kerf/query.hpp>
#include <kerf/shared.hpp>
#include <kerf/triangle.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// A node of a binary tree. Node 0 is the root.
///
///        0        Children stand side by side: an inner node's right child
///       / \       is its left child plus one. Every child comes after its parent.
///      1   2
///     / \ .
///    3   4
struct BinaryNode {
  Box3f bounds;             ///< around all that is below the node
  std::uint32_t first = 0;  ///< inner node: number of the left child; leaf: place of its first reference
  std::uint32_t count = 0;  ///< inner node: 0; leaf: its number of references

  bool is_leaf() const { return count != 0; }        ///< otherwise it is an inner node
  std::uint32_t left() const { return first; }       ///< of an inner node: number of the left child
  std::uint32_t right() const { return first + 1; }  ///< of an inner node: number of the right child
};
static_assert(sizeof(BinaryNode) == 32);

struct KERF_API TreeContent;  // what a `Tree` holds: private to the library

/// A binary bounding volume hierarchy over meshes, as `build_tree` returns it. A handle: copies share one
/// tree, which never changes. The meshes must stay in memory as they are while the tree is used.
class KERF_API Tree {
 public:
  /// A tree of nothing, without nodes.
  Tree() noexcept = default;

  /// All nodes, parents before their children. Valid as long as this handle or a copy of it.
  std::span<const BinaryNode> nodes() const;

  /// The triangles of the leaves, leaf after leaf, by their number counted over all meshes.
  std::span<const std::uint32_t> references() const;

  std::size_t triangles() const;             ///< in the meshes given
  std::size_t degenerate_triangles() const;  ///< of these, left out because they have no area
  std::size_t non_finite_triangles() const;  ///< left out by `NonFinite::skip`

  /// The place in the meshes of the triangle with number `id`.
  PrimitiveId locate(std::uint32_t id) const;

  /// The vertices of the triangle with number `id`.
  Triangle triangle(std::uint32_t id) const;

 private:
  friend struct TreeContent;
  explicit Tree(Shared<TreeContent> content) noexcept : content_(std::move(content)) {}

  Shared<TreeContent> content_;
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
