#include "files/check_structure.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "math/vec3f.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {
namespace {

// A thread checks this many nodes in about 50 us. Fewer are not worth waking another thread.
constexpr std::uint32_t nodes_per_block = 256;

// `number` says where: of a node, a triangle, a mesh.
[[noreturn]] void refuse(const char* what, std::size_t number) {
  raise(Error::bad_format, "%s (%zu)", what, number);
}

void check_meshes(std::span<const std::uint32_t> first, const FileHeader& header) {
  if (first.front() != 0 || !std::is_sorted(first.begin(), first.end()))
    refuse("the meshes are out of order", 0);
  if (first.back() >= std::uint32_t{1} << 31 || first.back() != header.triangles ||
      header.degenerate_triangles > header.triangles) {
    refuse("the meshes have another number of triangles", first.back());
  }
}

// Whether the order names each slot once, and nothing else.
template <class Node>
bool is_permutation(typename Node::Order order) {
  std::uint32_t named = 0;
  for (std::uint32_t place = 0; place < Node::width; ++place)
    named |= 1u << ((order >> (Node::slot_bits * place)) & ((1u << Node::slot_bits) - 1));
  if constexpr (8 * sizeof(order) > Node::slot_bits * Node::width) {
    if (order >> (Node::slot_bits * Node::width) != 0) return false;
  }
  return named == (1u << Node::width) - 1;
}

// Infinities and values that are not numbers have all bits of the exponent set.
bool all_finite(const std::uint32_t* words, std::size_t count) {
  constexpr std::uint32_t exponent = 0x7f800000;
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < count; ++i)
    found |= static_cast<std::uint32_t>((words[i] & exponent) == exponent);
  return found == 0;
}

// Links lead to later nodes only, and no two lead to the same node. That is a tree, in which every traversal
// comes to an end.
template <class Node>
void check_links(const WideBvh& wide) {
  static_assert(max_tree_depth < 255);
  std::vector<std::uint8_t> depths(wide.node_count, 0);  // of each node; 0 until a link to it is met
  depths[0] = 1;
  std::uint32_t max_depth = 0;
  for (std::uint32_t number = 0; number < wide.node_count; ++number) {
    const std::uint8_t depth = depths[number];
    if (depth == 0) refuse("a node that no other leads to", number);
    if (depth > max_tree_depth) refuse("a node too deep for any traversal", number);
    max_depth = std::max<std::uint32_t>(max_depth, depth);
    for (const ChildLink child : wide.nodes<Node>()[number].children) {
      if (child.is_leaf()) continue;
      if (child.node() <= number || child.node() >= depths.size())
        refuse("a link to an impossible node", number);
      if (depths[child.node()] != 0) refuse("a second link to a node", child.node());
      depths[child.node()] = static_cast<std::uint8_t>(depth + 1);
    }
  }
  if (max_depth != wide.depth) refuse("the hierarchy has another depth", max_depth);
}

// Checks the orders, boxes and leaves of a node.
template <class Node>
class NodeCheck {
 public:
  NodeCheck(const WideBvh& wide, std::uint32_t triangles)
      : wide_(wide), triangles_(triangles), references_(wide.references()) {}

  void operator()(std::uint32_t number) {
    const Node& node = wide_.nodes<Node>()[number];
    if (!std::all_of(std::begin(node.order), std::end(node.order), is_permutation<Node>)) {
      refuse("a node whose visiting order does not name each child once", number);
    }
    for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
      const ChildLink child = node.children[slot];
      const Box3f box = child_box(node, slot);
      if (box == Box3f{}) {
        check_unused(child, number);
      } else {
        if (!is_finite(box.lower) || !is_finite(box.upper) || box.empty())
          refuse("a node with an impossible box", number);
        if (child.is_leaf()) check_leaf(child);
      }
    }
  }

 private:
  // Overflowing arithmetic may lead a ray there. As a rule all unused slots name the same leaf.
  void check_unused(ChildLink child, std::uint32_t number) {
    if (!child.is_leaf()) refuse("an unused slot that names a node", number);
    if (child.bits() == unused_.bits()) return;
    check_leaf(child);
    unused_ = child;
  }

  void check_leaf(ChildLink leaf) const {
    if (leaf.first() + leaf.count() > references_) refuse("a leaf outside the triangles", leaf.first());
    const std::uint32_t* words = wide_.leaves.data() + words_per_triangle * leaf.first();
    const std::size_t coordinates = std::size_t{9} * leaf.count();
    if (!all_finite(words, coordinates)) refuse("a triangle that is not finite", leaf.first());
    for (std::uint32_t i = 0; i < leaf.count(); ++i) {
      if (words[coordinates + i] >= triangles_) refuse("a triangle that no mesh has", words[coordinates + i]);
    }
  }

  const WideBvh& wide_;
  std::uint32_t triangles_;
  std::size_t references_;
  ChildLink unused_;  // the last one of an unused slot that was checked; a node if there is none
};

template <class Node>
void check_nodes(const WideBvh& wide, std::uint32_t triangles) {
  const std::uint32_t count = wide.node_count;
  const auto check = [&](std::uint32_t begin, std::uint32_t end) {
    NodeCheck<Node> check_node(wide, triangles);
    for (std::uint32_t number = begin; number < end; ++number) check_node(number);
  };
  if (count <= nodes_per_block) return check(0, count);
  try {
    parallel_for_ranges(0u, count, nodes_per_block,
                        [&](const auto& range) { check(range.begin(), range.end()); });
  } catch (const Error&) {
    check(0, count);  // names the first wrong node, whichever thread found one first
    throw;
  }
}

}  // namespace

void check_structure(const WideBvh& wide, std::span<const std::uint32_t> first_triangles,
                     const FileHeader& header) {
  check_meshes(first_triangles, header);
  if (wide.empty()) {
    if (!wide.leaves.empty() || wide.depth != 0 || wide.bounds != Box3f{})
      refuse("triangles without nodes", 0);
    return;
  }
  if (wide.leaves.size() < leaf_padding_words + words_per_triangle ||
      (wide.leaves.size() - leaf_padding_words) % words_per_triangle != 0) {
    refuse("leaf data of an impossible size", wide.leaves.size());
  }
  if (!is_finite(wide.bounds.lower) || !is_finite(wide.bounds.upper) || wide.bounds.empty()) {
    refuse("impossible bounds", 0);
  }
  with_width(wide.width, [&](auto width) {
    check_nodes<WideNode<width>>(wide, first_triangles.back());
    check_links<WideNode<width>>(wide);
  });
}

}  // namespace kerf
