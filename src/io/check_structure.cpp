#include <algorithm>
#include <bit>
#include <cstdio>
#include <vector>

#include <kerf/error.hpp>

#include "io/file_image.hpp"
#include "math/vec3f.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {
namespace {

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

class NodeChecks {
 public:
  explicit NodeChecks(const Bvh::Structure& structure)
      : wide_(structure.wide),
        triangles_(structure.first_triangles.back()),
        references_(wide_.references()),
        depths_(wide_.nodes.size(), 0) {}

  void run() {
    depths_[0] = 1;
    std::uint32_t deepest = 0;
    for (std::uint32_t i = 0; i < wide_.nodes.size(); ++i) {
      if (depths_[i] == 0) refuse("a node that no other leads to", i);
      if (depths_[i] > max_tree_depth) refuse("a node too deep for any traversal", i);
      deepest = std::max<std::uint32_t>(deepest, depths_[i]);
      check(i);
    }
    if (deepest != wide_.depth) refuse("the hierarchy has another depth", deepest);
  }

 private:
  void check(std::uint32_t number) {
    const WideNode& node = wide_.nodes[number];
    if (!std::all_of(std::begin(node.order), std::end(node.order), is_permutation)) {
      refuse("a node whose visiting order does not name each child once", number);
    }
    for (std::uint32_t slot = 0; slot < wide_node_children; ++slot) {
      const Box3f box = child_box(node, slot);
      if (box == Box3f{}) {
        check_unused(node.children[slot], number);
        continue;
      }
      if (!is_finite(box.lower) || !is_finite(box.upper) || box.empty())
        refuse("a node with an impossible box", number);
      const ChildLink child = node.children[slot];
      if (child.is_leaf()) {
        check_leaf(child);
      } else {
        // Links only lead onward, and no two to the same node: a tree, which every traversal leaves again.
        if (child.node() <= number || child.node() >= depths_.size())
          refuse("a link to an impossible node", number);
        if (depths_[child.node()] != 0) refuse("a second link to a node", child.node());
        depths_[child.node()] = static_cast<std::uint8_t>(depths_[number] + 1);
      }
    }
  }

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
  ChildLink unused_;                  // of an unused slot, checked; a node until there is one
  std::vector<std::uint8_t> depths_;  // of each node; 0 until a link to it is met
};
static_assert(max_tree_depth < 255);

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
  NodeChecks(structure).run();
}

}  // namespace kerf
