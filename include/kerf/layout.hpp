// The structure that rays are traced through, as it lies in memory and as docs/file-format.md describes it:
// for tools that look at it and for traversals of one's own, on a GPU for example. Tracing with `Bvh` needs
// none of this.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include <kerf/export.hpp>
#include <kerf/query.hpp>
#include <kerf/triangle.hpp>
#include <kerf/vec.hpp>

namespace kerf {

class Bvh;

/// A leaf holds from 1 to this many triangles.
inline constexpr std::uint32_t max_leaf_triangles = 8;

/// What a node has in one of its slots: another node, or a leaf. In 32 bits:
///
///     bit 31   30..28      27..0
///     0        number of the node
///     1        count - 1   number of the triangles that lie before the leaf
class ChildLink {
 public:
  static constexpr std::uint32_t place_bits = 28;                     ///< bits of a leaf's place
  static constexpr std::uint32_t max_place = (1u << place_bits) - 1;  ///< the largest number of both kinds

  constexpr ChildLink() = default;
  /// A link by its 32 bits.
  constexpr explicit ChildLink(std::uint32_t bits) : bits_(bits) {}
  /// The link to the node with that number.
  static constexpr ChildLink node(std::uint32_t number) { return ChildLink(number); }
  /// The link to a leaf of `count` triangles, before which `first` triangles lie.
  static constexpr ChildLink leaf(std::uint32_t first, std::uint32_t count) {
    return ChildLink((1u << 31) | ((count - 1) << place_bits) | first);
  }

  constexpr bool is_leaf() const { return (bits_ >> 31) != 0; }        ///< otherwise it is a node
  constexpr std::uint32_t node() const { return bits_; }               ///< of a node: its number
  constexpr std::uint32_t first() const { return bits_ & max_place; }  ///< of a leaf: triangles before it
  constexpr std::uint32_t count() const {
    return ((bits_ >> place_bits) & 7u) + 1;
  }                                                       ///< of a leaf: triangles
  constexpr std::uint32_t bits() const { return bits_; }  ///< all 32 bits

 private:
  std::uint32_t bits_ = 0;
};

/// A node of sixteen slots. Children fill the slots from 0 up; an unused slot has an empty box and the link
/// of some leaf.
struct alignas(64) WideNode {
  static constexpr std::uint32_t width = 16;  ///< number of slots

  float planes[3][2][width];  ///< boxes of the children: [axis][0: lower, 1: upper][slot]
  ChildLink children[width];  ///< what is in each slot

  /// For each octant of ray directions (bit a of the octant's number is set where the direction is negative
  /// along axis a), the slots from near to far, four bits each, the nearest in the lowest (after Fuetterling
  /// et al. 2017, "Accelerated Single Ray Tracing for Wide Vector Units").
  std::uint64_t order[8];
};
static_assert(sizeof(WideNode) == 512);

/// A leaf of n triangles is ten rows of n words: x, y, z of the first vertices, of the second, of the third,
/// then the triangles' numbers. Leaves lie side by side, so that a leaf with k triangles before it begins at
/// word 10 k.
inline constexpr std::size_t words_per_triangle = 10;

/// Traversal reads rows eight words at a time. Behind the last leaf lie this many words that mean nothing.
inline constexpr std::size_t leaf_padding_words = 16;

/// The arrays of a hierarchy. A view, valid as long as the `Bvh` that it was taken from, or a copy of that.
/// Triangles have numbers, counted over all meshes in the order given to `build`; `locate` says which mesh.
struct Layout {
  std::span<const WideNode> nodes;  ///< the first is the root; none in a hierarchy of nothing
  /// `words_per_triangle` for each triangle in a leaf and `leaf_padding_words` behind the last; none in a
  /// hierarchy of nothing. A triangle that stands in several leaves is stored in each.
  std::span<const std::uint32_t> leaves;
  Box3f bounds;                     ///< around all triangles
  float largest_coordinate = 0.0f;  ///< the largest absolute value in `bounds`
  std::uint32_t depth = 0;          ///< nodes on the longest path from the root to a leaf
  /// For each mesh the number of its first triangle; one more entry ends the last mesh. None in a
  /// default-constructed `Bvh`.
  std::span<const std::uint32_t> first_triangles;
};

/// The arrays of `bvh`.
KERF_API Layout layout(const Bvh& bvh);

/// The box of a child; empty for an unused slot.
inline Box3f child_box(const WideNode& node, std::uint32_t slot) {
  Box3f box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = node.planes[axis][0][slot];
    box.upper[axis] = node.planes[axis][1][slot];
  }
  return box;
}

/// Triangle `i` of a leaf, `0 <= i < leaf.count()`. `leaves` is `Layout::leaves`.
inline Triangle triangle_in(std::span<const std::uint32_t> leaves, ChildLink leaf, std::uint32_t i) {
  const std::uint32_t* word = leaves.data() + words_per_triangle * leaf.first() + i;
  Triangle triangle;
  for (Vec3f* vertex : {&triangle.v0, &triangle.v1, &triangle.v2}) {
    for (int axis = 0; axis < 3; ++axis, word += leaf.count()) (*vertex)[axis] = std::bit_cast<float>(*word);
  }
  return triangle;
}

/// The number of that triangle.
inline std::uint32_t triangle_id(std::span<const std::uint32_t> leaves, ChildLink leaf, std::uint32_t i) {
  return leaves[words_per_triangle * leaf.first() + 9 * leaf.count() + i];
}

/// Calls `visit(id, triangle)` for every triangle in a leaf, as often as it stands in one.
template <class Visit>
void visit_triangles(const Layout& layout, Visit&& visit) {
  for (const WideNode& node : layout.nodes) {
    for (std::uint32_t slot = 0; slot < WideNode::width; ++slot) {
      const ChildLink child = node.children[slot];
      if (!child.is_leaf() || child_box(node, slot).empty()) continue;
      for (std::uint32_t i = 0; i < child.count(); ++i)
        visit(triangle_id(layout.leaves, child, i), triangle_in(layout.leaves, child, i));
    }
  }
}

/// The triangle with number `id` by its mesh. `first_triangles` is `Layout::first_triangles`.
inline PrimitiveId locate(std::span<const std::uint32_t> first_triangles, std::uint32_t id) {
  if (first_triangles.size() == 2) return {id, 0};  // one mesh
  const auto after = std::upper_bound(first_triangles.begin(), first_triangles.end(), id);
  const auto mesh = static_cast<std::uint32_t>(after - first_triangles.begin() - 1);
  return {id - first_triangles[mesh], mesh};
}

}  // namespace kerf
