// From merged nodes to what kernels traverse: nodes in depth-first order, and the triangles of leaves side by
// side.
#pragma once

#include "../binary_layout.hpp"
#include "ploc.hpp"

namespace kerf::cuda {

/// Where a node stands in depth-first order.
struct DepthFirstPlace {
  std::uint32_t reference;  // references before it
  std::uint32_t node;       // inner nodes before it
  bool in_leaf;             // an ancestor becomes a leaf
};

KERF_CUDA_INLINE DepthFirstPlace depth_first_place(const MergedNode* nodes, std::uint32_t number) {
  DepthFirstPlace place{0, 0, false};
  for (std::uint32_t parent = nodes[number].parent; parent != no_node; parent = nodes[number].parent) {
    const MergedNode& above = nodes[parent];
    place.in_leaf |= becomes_leaf(above);
    ++place.node;
    if (above.child[1] == number) {
      const MergedNode& left = nodes[above.child[0]];
      place.reference += left.references;
      place.node += left.inner;
    }
    number = parent;
  }
  return place;
}

/// Reference i to its leaf.
struct PlaceReference {
  const MergedNode* nodes;
  const DeviceTriangle* triangles;
  DeviceTriangle* out;
  std::uint32_t* numbers;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    const std::uint32_t place = depth_first_place(nodes, i).reference, triangle = nodes[i].child[0];
    out[place] = triangles[triangle];
    numbers[place] = triangle;
  }
};

/// Inner node i, counted from the first, with the boxes of its children.
struct PlaceNode {
  const MergedNode* nodes;
  std::uint32_t references;  // in all
  PairNode* out;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    const std::uint32_t number = references + i;
    const MergedNode& node = nodes[number];
    if (becomes_leaf(node)) return;
    const DepthFirstPlace place = depth_first_place(nodes, number);
    if (place.in_leaf) return;
    const MergedNode &a = nodes[node.child[0]], &b = nodes[node.child[1]];
    std::uint32_t parent = no_link;
    if (node.parent != no_node) {
      const MergedNode& above = nodes[node.parent];
      parent = place.node - 1 - (above.child[1] == number ? nodes[above.child[0]].inner : 0);
    }
    out[place.node] = pair_node(a.box, b.box, link(a, place.reference, place.node + 1),
                                link(b, place.reference + a.references, place.node + 1 + a.inner), parent);
  }

  KERF_CUDA_INLINE static std::uint32_t link(const MergedNode& node, std::uint32_t reference,
                                             std::uint32_t place) {
    return becomes_leaf(node) ? leaf_link(reference, node.references) : place;
  }
  KERF_CUDA_INLINE static PairNode pair_node(const Box& a, const Box& b, std::uint32_t first,
                                             std::uint32_t second, std::uint32_t parent) {
    PairNode pair;
    pair.first_xy[0] = a.lower[0];
    pair.first_xy[1] = a.upper[0];
    pair.first_xy[2] = a.lower[1];
    pair.first_xy[3] = a.upper[1];
    pair.second_xy[0] = b.lower[0];
    pair.second_xy[1] = b.upper[0];
    pair.second_xy[2] = b.lower[1];
    pair.second_xy[3] = b.upper[1];
    pair.z[0] = a.lower[2];
    pair.z[1] = a.upper[2];
    pair.z[2] = b.lower[2];
    pair.z[3] = b.upper[2];
    pair.link[0] = first;
    pair.link[1] = second;
    pair.parent = parent;
    pair.arrived = 0;
    return pair;
  }
};

/// A tree that is one leaf: it stands twice in its root, which asks for two children.
struct PlaceLeaf {
  const MergedNode* nodes;
  std::uint32_t root;
  PairNode* out;

  KERF_CUDA_BOTH void operator()(std::uint32_t) const {
    const MergedNode& node = nodes[root];
    const std::uint32_t link = leaf_link(0, node.references);
    out[0] = PlaceNode::pair_node(node.box, node.box, link, link, no_link);
  }
};

}  // namespace kerf::cuda
