// The structure that rays are traced through, as it lies in memory and as docs/file-format.md describes it:
// for tools that look at it and for traversals of one's own, on a GPU for example. Tracing with `Bvh` needs
// none of this.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

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

/// A node of `slots` slots: sixteen, eight or four. Children fill the slots from 0 up; an unused slot has an
/// empty box and the link of some leaf.
template <std::uint32_t slots>
struct alignas(64) WideNode {
  static_assert(slots == 16 || slots == 8 || slots == 4);
  static constexpr std::uint32_t width = slots;                   ///< number of slots
  static constexpr std::uint32_t slot_bits = slots == 4 ? 2 : 4;  ///< of a slot's number in an order
  /// As many bits as an order has; twice as many for four slots, so that a node has no gap.
  using Order = std::conditional_t<slots == 16, std::uint64_t,
                                   std::conditional_t<slots == 8, std::uint32_t, std::uint16_t>>;

  float planes[3][2][width];  ///< boxes of the children: [axis][0: lower, 1: upper][slot]
  ChildLink children[width];  ///< what is in each slot

  /// For each octant of ray directions (bit a of the octant's number is set where the direction is negative
  /// along axis a), the slots from near to far, `slot_bits` each, the nearest in the lowest (after
  /// Fuetterling et al. 2017, "Accelerated Single Ray Tracing for Wide Vector Units").
  Order order[8];
};
static_assert(sizeof(WideNode<16>) == 512 && sizeof(WideNode<8>) == 256 && sizeof(WideNode<4>) == 128);

/// A leaf of n triangles is ten rows of n words: x, y, z of the first vertices, of the second, of the third,
/// then the triangles' numbers. Leaves lie side by side, so that a leaf with k triangles before it begins at
/// word 10 k.
inline constexpr std::size_t words_per_triangle = 10;

/// Traversal reads rows eight words at a time. Behind the last leaf lie this many words that mean nothing.
inline constexpr std::size_t leaf_padding_words = 16;

/// The box of a child; empty for an unused slot.
template <std::uint32_t width>
Box3f child_box(const WideNode<width>& node, std::uint32_t slot) {
  Box3f box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = node.planes[axis][0][slot];
    box.upper[axis] = node.planes[axis][1][slot];
  }
  return box;
}

/// The arrays of a hierarchy. A view, valid as long as the `Bvh` that it was taken from, or a copy of that.
/// Triangles have numbers, counted over all meshes in the order given to `build`; `locate` says which mesh.
struct Layout {
  std::uint32_t width = 16;      ///< of all nodes: as many slots as are fastest on the machine
  std::uint32_t node_count = 0;  ///< number of nodes; 0 in a hierarchy of nothing
  const void* nodes = nullptr;   ///< `node_count` of `WideNode<width>`, the first of which is the root
  /// `words_per_triangle` for each triangle in a leaf and `leaf_padding_words` behind the last; none in a
  /// hierarchy of nothing. A triangle that stands in several leaves is stored in each.
  std::span<const std::uint32_t> leaves;
  Box3f bounds;                     ///< around all triangles
  float largest_coordinate = 0.0f;  ///< the largest absolute value in `bounds`
  std::uint32_t depth = 0;          ///< nodes on the longest path from the root to a leaf
  /// For each mesh the number of its first triangle; one more entry ends the last mesh. None in a
  /// default-constructed `Bvh`.
  std::span<const std::uint32_t> first_triangles;

  /// Calls `visit(nodes)` with the nodes as a span of `const WideNode<width>`, and returns what it returns.
  template <class Visit>
  auto with_nodes(Visit&& visit) const {
    if (width == 16) return visit(std::span(static_cast<const WideNode<16>*>(nodes), node_count));
    if (width == 8) return visit(std::span(static_cast<const WideNode<8>*>(nodes), node_count));
    return visit(std::span(static_cast<const WideNode<4>*>(nodes), node_count));
  }

  /// What is in a slot of a node.
  ChildLink child(std::uint32_t node, std::uint32_t slot) const {
    return with_nodes([&](const auto& all) { return all[node].children[slot]; });
  }
  /// Its box; empty for an unused slot.
  Box3f box(std::uint32_t node, std::uint32_t slot) const {
    return with_nodes([&](const auto& all) { return child_box(all[node], slot); });
  }
};

/// The arrays of `bvh`.
KERF_API Layout layout(const Bvh& bvh);

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
  layout.with_nodes([&](const auto& nodes) {
    for (const auto& node : nodes) {
      for (std::uint32_t slot = 0; slot < layout.width; ++slot) {
        const ChildLink child = node.children[slot];
        if (!child.is_leaf() || child_box(node, slot).empty()) continue;
        for (std::uint32_t i = 0; i < child.count(); ++i)
          visit(triangle_id(layout.leaves, child, i), triangle_in(layout.leaves, child, i));
      }
    }
  });
}

/// The triangle with number `id` by its mesh. `first_triangles` is `Layout::first_triangles`.
inline PrimitiveId locate(std::span<const std::uint32_t> first_triangles, std::uint32_t id) {
  if (first_triangles.size() == 2) return {id, 0};  // one mesh
  const auto after = std::upper_bound(first_triangles.begin(), first_triangles.end(), id);
  const auto mesh = static_cast<std::uint32_t>(after - first_triangles.begin() - 1);
  return {id - first_triangles[mesh], mesh};
}

}  // namespace kerf

#endif  // KERF_HAS_CPP20
