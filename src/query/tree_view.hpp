// What the queries see of the structure that is traced: nodes with boxes, leaves with triangles.
#pragma once

#include <algorithm>
#include <cstdint>

#include <kerf/query.hpp>

#include "structure.hpp"

namespace kerf {

class TreeView {
 public:
  using Node = ChildLink;

  explicit TreeView(const Bvh::Structure& structure) : structure_(structure) {}

  bool empty() const { return structure_.wide.empty(); }
  Node root() const { return ChildLink::node(0); }
  Box3f bounds() const { return structure_.wide.bounds; }
  bool is_leaf(Node node) const { return node.is_leaf(); }

  /// Calls `visit(child, box)` for each child of an inner node.
  template <class Visit>
  void for_each_child(Node node, Visit&& visit) const {
    const WideNode& inner = structure_.wide.nodes[node.node()];
    for (std::uint32_t slot = 0; slot < wide_node_children; ++slot) {
      const Box3f box = child_box(inner, slot);
      if (!box.empty()) visit(inner.children[slot], box);
    }
  }

  /// Calls `visit(id, triangle)` for each triangle of a leaf; `id` numbers the triangles of all meshes.
  template <class Visit>
  void for_each_triangle(Node leaf, Visit&& visit) const {
    for (std::uint32_t i = 0; i < leaf.count(); ++i) {
      visit(triangle_id(structure_.wide, leaf, i), triangle_in(structure_.wide, leaf, i));
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
