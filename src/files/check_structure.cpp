#include <algorithm>
#include <bit>
#include <cstdio>
#include <vector>

#include <kerf/error.hpp>

#include "base/parallel.hpp"
#include "files/file_image.hpp"
#include "math/vec3f.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {
namespace {

// A thread checks this many in about 50 us: fewer are not worth another's waking.
constexpr std::uint32_t nodes_a_part = 256;

[[noreturn]] void refuse(const char* what, std::size_t where) {
  char sentence[256];
  std::snprintf(sentence, sizeof sentence, "%s (%zu)", what, where);
  throw Error(Error::bad_format, sentence);
}

void check_meshes(const Bvh::Structure& structure) {
  const auto& first = structure.first_triangles;
  if (first.front() != 0 || !std::is_sorted(first.begin(), first.end()))
    refuse("the meshes are out of order", 0);
  if (first.back() >= std::uint32_t{1} << 31 || first.back() != structure.statistics.triangles ||
      structure.statistics.degenerate_triangles > structure.statistics.triangles) {
    refuse("the meshes have another number of triangles", first.back());
  }
}

// Whether the order names each of the sixteen slots once.
bool is_permutation(std::uint64_t order) {
  std::uint32_t named = 0;
  for (std::uint32_t place = 0; place < wide_node_children; ++place)
    named |= 1u << ((order >> (4 * place)) & 15);
  return named == 0xffff;
}

// Infinities and values that are not numbers have all bits of the exponent set.
bool all_finite(const std::uint32_t* words, std::size_t count) {
  constexpr std::uint32_t exponent = 0x7f800000;
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < count; ++i)
    found |= static_cast<std::uint32_t>((words[i] & exponent) == exponent);
  return found == 0;
}

// Links only lead onward, and no two to the same node: a tree, which every traversal leaves again.
void check_links(const WideBvh& wide) {
  static_assert(max_tree_depth < 255);
  std::vector<std::uint8_t> depths(wide.nodes.size(), 0);  // of each node; 0 until a link to it is met
  depths[0] = 1;
  std::uint32_t deepest = 0;
  for (std::uint32_t number = 0; number < wide.nodes.size(); ++number) {
    const std::uint8_t depth = depths[number];
    if (depth == 0) refuse("a node that no other leads to", number);
    if (depth > max_tree_depth) refuse("a node too deep for any traversal", number);
    deepest = std::max<std::uint32_t>(deepest, depth);
    for (const ChildLink child : wide.nodes[number].children) {
      if (child.is_leaf()) continue;
      if (child.node() <= number || child.node() >= depths.size())
        refuse("a link to an impossible node", number);
      if (depths[child.node()] != 0) refuse("a second link to a node", child.node());
      depths[child.node()] = static_cast<std::uint8_t>(depth + 1);
    }
  }
  if (deepest != wide.depth) refuse("the hierarchy has another depth", deepest);
}

// What else there is to a node: orders, boxes, leaves.
class NodeCheck {
 public:
  explicit NodeCheck(const Bvh::Structure& structure)
      : wide_(structure.wide),
        triangles_(structure.first_triangles.back()),
        references_(wide_.references()) {}

  void operator()(std::uint32_t number) {
    const WideNode& node = wide_.nodes[number];
    if (!std::all_of(std::begin(node.order), std::end(node.order), is_permutation)) {
      refuse("a node whose visiting order does not name each child once", number);
    }
    for (std::uint32_t slot = 0; slot < wide_node_children; ++slot) {
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
  // Arithmetic on the strangest rays may lead there. As a rule they all name the same leaf.
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
  ChildLink unused_;  // of an unused slot, checked; a node until there is one
};

void check_nodes(const Bvh::Structure& structure) {
  const auto count = static_cast<std::uint32_t>(structure.wide.nodes.size());
  const auto check = [&](std::uint32_t begin, std::uint32_t end) {
    NodeCheck check_node(structure);
    for (std::uint32_t number = begin; number < end; ++number) check_node(number);
  };
  if (count <= nodes_a_part) return check(0, count);
  try {
    parallel_for_ranges(0u, count, nodes_a_part,
                        [&](const auto& range) { check(range.begin(), range.end()); });
  } catch (const Error&) {
    check(0, count);  // of all that is wrong, the first is named, whichever thread saw it first
    throw;
  }
}

}  // namespace

void check_structure(const Bvh::Structure& structure) {
  check_meshes(structure);
  const WideBvh& wide = structure.wide;
  if (wide.nodes.empty()) {
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
  check_nodes(structure);
  check_links(wide);
}

}  // namespace kerf
