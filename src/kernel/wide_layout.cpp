#include "kernel/wide_layout.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include <kerf/error.hpp>

#include "parallel.hpp"
#include "refine/collapse.hpp"
#include "tree/aligned_array.hpp"

namespace kerf {
namespace {

// The different triangles below a binary node, which has at most eight references.
struct LeafTriangles {
  std::array<std::uint32_t, wide_leaf_triangles> ids;
  std::uint32_t count = 0;
};

void gather(const BinaryTree& tree, std::uint32_t node, LeafTriangles& triangles) {
  const BinaryNode& binary = tree.nodes[node];
  if (!binary.is_leaf()) {
    gather(tree, binary.left(), triangles);
    gather(tree, binary.right(), triangles);
    return;
  }
  for (std::uint32_t i = binary.first; i < binary.first + binary.count; ++i) {
    const auto end = triangles.ids.begin() + triangles.count;
    if (std::find(triangles.ids.begin(), end, tree.references[i]) == end) {
      triangles.ids[triangles.count++] = tree.references[i];
    }
  }
}

// A wide node before it is written: where it comes from and what its children will be called.
struct Plan {
  std::uint32_t binary;
  std::array<ChildLink, wide_node_children> links;
};

struct Outline {
  std::vector<Plan> plans;
  std::uint32_t triangles = 0;
  std::uint32_t depth = 0;
};

// Any-hit traversal takes the last slot first: there goes what is most likely to be hit, the largest (Nah &
// Manocha 2014, "SATO: Surface Area Traversal Order for Shadow Ray Tracing").
Collapse::Children in_slots(const BinaryTree& tree, Collapse::Children children) {
  std::stable_sort(children.node.begin(), children.node.begin() + children.count, [&](auto a, auto b) {
    return half_area(tree.nodes[a].bounds) < half_area(tree.nodes[b].bounds);
  });
  return children;
}

// Numbers nodes and leaves depth first, so that a subtree lies together.
Outline outline(const BinaryTree& tree, const Collapse& collapse) {
  Outline result;
  struct Open {
    std::uint32_t binary, parent, slot, depth;
  };
  std::vector<Open> open{{0, 0, 0, 1}};
  while (!open.empty()) {
    const Open task = open.back();
    open.pop_back();
    const auto number = static_cast<std::uint32_t>(result.plans.size());
    if (number > 0) result.plans[task.parent].links[task.slot] = ChildLink::node(number);
    result.depth = std::max(result.depth, task.depth);
    Plan plan{.binary = task.binary, .links = {}};
    const Collapse::Children children = in_slots(tree, collapse.children(task.binary));
    for (std::uint32_t slot = 0; slot < children.count; ++slot) {
      if (!collapse.is_leaf(children.node[slot])) continue;
      LeafTriangles leaf;
      gather(tree, children.node[slot], leaf);
      if (result.triangles + leaf.count > ChildLink::max_place) {
        throw Error(Error::too_large,
                    "the hierarchy has more than 2^28 references, which is more than kerf can number");
      }
      plan.links[slot] = ChildLink::leaf(result.triangles, leaf.count);
      result.triangles += leaf.count;
    }
    for (std::uint32_t slot = children.count; slot-- > 0;) {
      if (!collapse.is_leaf(children.node[slot]))
        open.push_back({children.node[slot], number, slot, task.depth + 1});
    }
    result.plans.push_back(plan);
  }
  return result;
}

void write_leaf(const Geometry& geometry, const LeafTriangles& leaf, std::uint32_t* words) {
  for (std::uint32_t i = 0; i < leaf.count; ++i) {
    const Triangle triangle = geometry.triangle(leaf.ids[i]);
    std::uint32_t* word = words + i;
    for (const Vec3f& vertex : {triangle.v0, triangle.v1, triangle.v2}) {
      for (int axis = 0; axis < 3; ++axis, word += leaf.count)
        *word = std::bit_cast<std::uint32_t>(vertex[axis]);
    }
    *word = leaf.ids[i];
  }
}

// From near to far for directions in `octant`, by how far along the octant's diagonal the boxes lie.
std::uint32_t order_of(const Box3f* boxes, std::uint32_t count, unsigned octant) {
  std::array<float, wide_node_children> distance;
  std::array<std::uint32_t, wide_node_children> slots;
  for (std::uint32_t slot = 0; slot < wide_node_children; ++slot) {
    slots[slot] = slot;
    distance[slot] = std::numeric_limits<float>::infinity();
    if (slot >= count) continue;
    const Vec3f center = boxes[slot].lower + boxes[slot].upper;
    distance[slot] = (octant & 1 ? -center.x : center.x) + (octant & 2 ? -center.y : center.y) +
                     (octant & 4 ? -center.z : center.z);
  }
  std::stable_sort(slots.begin(), slots.end(), [&](auto a, auto b) { return distance[a] < distance[b]; });
  std::uint32_t order = 0;
  for (std::uint32_t place = 0; place < wide_node_children; ++place) order |= slots[place] << (3 * place);
  return order;
}

}  // namespace

WideBvh make_wide_bvh(const Geometry& geometry, const BinaryTree& tree) {
  if (tree.empty()) return {};
  const Collapse collapse(tree);
  const Outline plan = outline(tree, collapse);
  const AlignedArray<WideNode> nodes(plan.plans.size());
  const AlignedArray<std::uint32_t> leaves(words_per_triangle * plan.triangles + leaf_padding_words);
  std::fill_n(leaves.data() + words_per_triangle * plan.triangles, leaf_padding_words, 0u);

  parallel_for_ranges(std::size_t{0}, nodes.size(), 64, [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Collapse::Children children = in_slots(tree, collapse.children(plan.plans[i].binary));
      WideNode& node = nodes[i];
      std::array<Box3f, wide_node_children> boxes;  // empty where unused
      for (std::uint32_t slot = 0; slot < children.count; ++slot)
        boxes[slot] = tree.nodes[children.node[slot]].bounds;
      for (std::uint32_t slot = 0; slot < wide_node_children; ++slot) {
        for (int axis = 0; axis < 3; ++axis) {
          node.planes[axis][0][slot] = boxes[slot].lower[axis];
          node.planes[axis][1][slot] = boxes[slot].upper[axis];
        }
        // An unused slot names a real leaf, so that no arithmetic on the strangest ray leads outside.
        node.children[slot] = slot < children.count ? plan.plans[i].links[slot] : ChildLink::leaf(0, 1);
        if (slot < children.count && node.children[slot].is_leaf()) {
          LeafTriangles leaf;
          gather(tree, children.node[slot], leaf);
          write_leaf(geometry, leaf, leaves.data() + words_per_triangle * node.children[slot].first());
        }
      }
      for (unsigned octant = 0; octant < 8; ++octant)
        node.order[octant] = order_of(boxes.data(), children.count, octant);
    }
  });
  const Box3f& bounds = tree.nodes[0].bounds;
  return {.nodes = {nodes.data(), nodes.size()},
          .leaves = {leaves.data(), leaves.size()},
          .bounds = bounds,
          .largest_coordinate = largest_coordinate(bounds),
          .depth = plan.depth,
          .node_memory = nodes.owner(),
          .leaf_memory = leaves.owner()};
}

}  // namespace kerf
