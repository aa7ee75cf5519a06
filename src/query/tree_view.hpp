// What the queries see of the structure that is traced: nodes with boxes, leaves with triangles.
#pragma once

#include <algorithm>
#include <cstdint>
#include <kerf/query.hpp>

#include "structure.hpp"

namespace kerf {

class TreeView {
 public:
  using Node = std::uint32_t;

  explicit TreeView(const Bvh::Structure& structure) : structure_(structure) {}

  bool empty() const { return structure_.tree.empty(); }
  Node root() const { return 0; }
  Box3f bounds() const { return empty() ? Box3f{} : structure_.tree.nodes[0].bounds; }
  bool is_leaf(Node node) const { return structure_.tree.nodes[node].is_leaf(); }

  /// Calls `visit(child, box)` for each child of an inner node.
  template <class Visit>
  void for_each_child(Node node, Visit&& visit) const {
    const BinaryNode& inner = structure_.tree.nodes[node];
    visit(inner.left(), structure_.tree.nodes[inner.left()].bounds);
    visit(inner.right(), structure_.tree.nodes[inner.right()].bounds);
  }

  /// Calls `visit(id, triangle)` for each triangle of a leaf; `id` numbers the triangles of all meshes.
  template <class Visit>
  void for_each_triangle(Node node, Visit&& visit) const {
    const BinaryNode& leaf = structure_.tree.nodes[node];
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      visit(structure_.tree.references[i], structure_.triangles[i]);
    }
  }

  PrimitiveId locate(std::uint32_t id) const {
    const auto& first = structure_.first_triangles;
    const auto mesh =
        static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), id) - first.begin() - 1);
    return {id - first[mesh], mesh};
  }

 private:
  const Bvh::Structure& structure_;
};

}  // namespace kerf
