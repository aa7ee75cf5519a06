#include "layout/lay_out.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include <kerf/error.hpp>

#include "base/aligned_array.hpp"
#include "base/parallel.hpp"
#include "layout/child_order.hpp"
#include "layout/collapse.hpp"
#include "layout/wide_children.hpp"

namespace kerf {
namespace {

static_assert(ChildLink::leaf(0, wide_leaf_triangles).count() == wide_leaf_triangles &&
              ChildLink::leaf(ChildLink::max_place, 1).first() == ChildLink::max_place);

// Writes the triangles below a binary node and returns the end of them.
std::uint32_t* gather(const BinaryTree& tree, std::uint32_t node, std::uint32_t* to) {
  const BinaryNode& binary = tree.nodes[node];
  if (!binary.is_leaf()) return gather(tree, binary.right(), gather(tree, binary.left(), to));
  for (std::uint32_t i = 0; i < binary.count; ++i) to[i] = tree.references[binary.first + i];
  return to + binary.count;
}

// The triangles below a binary node with at most as many references as a leaf has triangles.
struct LeafTriangles {
  std::array<std::uint32_t, wide_leaf_triangles> ids;
  std::uint32_t count = 0;
};

LeafTriangles distinct_triangles(const BinaryTree& tree, std::uint32_t node) {
  LeafTriangles all, distinct;
  all.count = static_cast<std::uint32_t>(gather(tree, node, all.ids.data()) - all.ids.data());
  for (std::uint32_t i = 0; i < all.count; ++i) {
    const auto end = distinct.ids.begin() + distinct.count;
    if (std::find(distinct.ids.begin(), end, all.ids[i]) == end) distinct.ids[distinct.count++] = all.ids[i];
  }
  return distinct;
}

// The row of triangle numbers of a leaf.
std::uint32_t* ids_of(std::uint32_t* leaves, ChildLink leaf) {
  return leaves + words_per_triangle * leaf.first() + (words_per_triangle - 1) * leaf.count();
}

// Writes the vertices of a leaf of `count` triangles whose numbers have been written.
template <std::uint32_t count>
void write_vertices(const Geometry& geometry, std::uint32_t* words) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [primitive, mesh] = geometry.locate(words[(words_per_triangle - 1) * count + i]);
    const TriangleMesh& m = geometry.meshes()[mesh];
    const auto corners = m.triangles[primitive];
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      const auto vertex = m.vertices[corners.values[corner]];
      for (std::uint32_t axis = 0; axis < 3; ++axis)
        words[(3 * corner + axis) * count + i] = std::bit_cast<std::uint32_t>(vertex.values[axis]);
    }
  }
}

void write_vertices(const Geometry& geometry, ChildLink leaf, std::uint32_t* leaves) {
  static_assert(wide_leaf_triangles == 8);
  constexpr void (*of_count[])(const Geometry&, std::uint32_t*) = {
      write_vertices<1>, write_vertices<2>, write_vertices<3>, write_vertices<4>,
      write_vertices<5>, write_vertices<6>, write_vertices<7>, write_vertices<8>};
  of_count[leaf.count() - 1](geometry, leaves + words_per_triangle * leaf.first());
}

// How many nodes and triangles there are, or how many come before.
struct Extent {
  std::size_t nodes = 0, triangles = 0;
};

// A single wide node near the root, or a whole subtree further down. One task lays out a section.
struct Section {
  std::uint32_t binary;
  std::uint32_t parent, slot;  // section and slot of the node above
  std::uint32_t depth;         // of its root; the root of the tree has 1
  bool is_subtree;
  Extent size, first;
  std::uint32_t max_depth;
  std::array<Prospect, max_node_width> below;  // of the children, if this is a single node
  Prospect prospect;
};

// A subtree of fewer than 2^(bits - 1) references is one section.
constexpr std::uint32_t large_bits = 13;

// Numbers nodes and leaves depth first, so that a subtree is contiguous: sections are found in this order,
// measured in parallel, numbered, and written in parallel.
template <class Node>
class LayoutWriter {
 public:
  LayoutWriter(const Geometry& geometry, const BinaryTree& tree, Target target, const Collapse& collapse)
      : geometry_(geometry), tree_(tree), target_(target), collapse_(collapse) {
    find_sections(0, 0, 0, 1);
    parallel_for(sections_.size(), [&](std::size_t i) { measure(sections_[i]); });
    for (Section& section : sections_) {
      section.first = total_;
      total_.nodes += section.size.nodes;
      total_.triangles += section.size.triangles;
      depth_ = std::max(depth_, section.max_depth);
    }
    if (total_.triangles > ChildLink::max_place) {
      throw Error(Error::too_large,
                  "the hierarchy has more than 2^28 references, which is more than kerf can number");
    }
  }

  LaidOut write() {
    nodes_ = AlignedArray<Node>(total_.nodes);
    leaves_ = AlignedArray<std::uint32_t>(words_per_triangle * total_.triangles + leaf_padding_words);
    std::fill_n(leaves_.data() + words_per_triangle * total_.triangles, leaf_padding_words, 0u);
    first_leaf_ = first_leaf();
    parallel_for(sections_.size(), [&](std::size_t i) { write_section(sections_[i]); });
    for (std::size_t i = sections_.size(); i-- > 0;) {  // children come after their parents
      Section& section = sections_[i];
      if (!section.is_subtree) {
        section.prospect = arrange(target_, tree_, collapse_.children(section.binary), section.below,
                                   nodes_[section.first.nodes]);
      }
      if (i == 0) break;
      Section& parent = sections_[section.parent];
      nodes_[parent.first.nodes].children[section.slot] =
          ChildLink::node(static_cast<std::uint32_t>(section.first.nodes));
      parent.below[section.slot] = section.prospect;
    }
    const Box3f& bounds = tree_.nodes[0].bounds;
    const WideBvh wide{.width = Node::width,
                       .node_count = static_cast<std::uint32_t>(nodes_.size()),
                       .node_data = nodes_.data(),
                       .leaves = {leaves_.data(), leaves_.size()},
                       .bounds = bounds,
                       .largest_coordinate = largest_coordinate(bounds),
                       .depth = depth_,
                       .node_memory = nodes_.owner(),
                       .leaf_memory = leaves_.owner()};
    return {wide, wide.node_bytes() + wide.leaves.size_bytes() + Collapse::bytes(tree_.nodes.size()) +
                      sections_.capacity() * sizeof(Section)};
  }

 private:
  // The leaf at place 0, which unused slots link to. Where distances overflow, a ray may meet even the empty
  // box of an unused slot. It then tests a leaf of the hierarchy, and what it finds is a hit like any other.
  ChildLink first_leaf() const {
    const auto section = std::find_if(sections_.begin(), sections_.end(),
                                      [](const Section& s) { return s.size.triangles != 0; });
    for (std::uint32_t binary = section->binary;;) {
      const Collapse::Children children = collapse_.children(binary);
      for (std::uint32_t i = 0; i < children.count; ++i) {
        if (collapse_.is_leaf(children.node[i])) return ChildLink::leaf(0, count_triangles(children.node[i]));
      }
      binary = children.node[0];
    }
  }

  void find_sections(std::uint32_t binary, std::uint32_t parent, std::uint32_t slot, std::uint32_t depth) {
    const auto index = static_cast<std::uint32_t>(sections_.size());
    const bool is_subtree = !collapse_.is_large(binary, large_bits);
    sections_.push_back({binary, parent, slot, depth, is_subtree, {}, {}, depth, {}, {}});
    if (is_subtree) return;
    const Collapse::Children children = collapse_.children(binary);
    for (std::uint32_t child = 0; child < children.count; ++child) {
      if (!collapse_.is_leaf(children.node[child]))
        find_sections(children.node[child], index, child, depth + 1);
    }
  }

  bool may_repeat() const { return tree_.min_divided_count <= wide_leaf_triangles; }

  std::uint32_t count_triangles(std::uint32_t leaf) const {
    return may_repeat() ? distinct_triangles(tree_, leaf).count : collapse_.few_references(leaf);
  }

  void write_triangles(std::uint32_t leaf, std::uint32_t* to) const {
    if (may_repeat()) {
      const LeafTriangles triangles = distinct_triangles(tree_, leaf);
      std::copy_n(triangles.ids.begin(), triangles.count, to);
    } else {
      gather(tree_, leaf, to);
    }
  }

  void measure(Section& section) const { measure(section.binary, section.depth, section); }

  void measure(std::uint32_t binary, std::uint32_t depth, Section& section) const {
    ++section.size.nodes;
    section.max_depth = std::max(section.max_depth, depth);
    const Collapse::Children children = collapse_.children(binary);
    for (std::uint32_t i = 0; i < children.count; ++i) collapse_.prefetch(children.node[i]);
    for (std::uint32_t i = 0; i < children.count; ++i) {
      if (collapse_.is_leaf(children.node[i])) {
        section.size.triangles += count_triangles(children.node[i]);
      } else if (section.is_subtree) {
        measure(children.node[i], depth + 1, section);
      }
    }
  }

  void write_section(Section& section) const {
    Extent next = section.first;
    if (section.is_subtree) {
      section.prospect = write_subtree(section.binary, next);
    } else {
      const Collapse::Children children = write_node(section.binary, section.below, next);
      std::array<const BinaryNode*, max_node_width> binaries{};
      for (std::uint32_t slot = 0; slot < children.count; ++slot)
        binaries[slot] = &tree_.nodes[children.node[slot]];
      write_children(target_, binaries.data(), children.count, nodes_[section.first.nodes]);
    }
    write_leaves(section.first.nodes, next.nodes);
  }

  Prospect write_subtree(std::uint32_t binary, Extent& next) const {
    Node& node = nodes_[next.nodes];
    std::array<Prospect, max_node_width> below;
    const Collapse::Children children = write_node(binary, below, next);
    for (std::uint32_t slot = 0; slot < children.count; ++slot) {
      if (collapse_.is_leaf(children.node[slot])) continue;
      node.children[slot] = ChildLink::node(static_cast<std::uint32_t>(next.nodes));
      below[slot] = write_subtree(children.node[slot], next);
    }
    return arrange(target_, tree_, children, below, node);
  }

  // Writes the links to the children, in the tree's order, and the triangle numbers of the leaves among them.
  // Children that are nodes are numbered later.
  Collapse::Children write_node(std::uint32_t binary, std::array<Prospect, max_node_width>& below,
                                Extent& next) const {
    Node& node = nodes_[next.nodes++];
    const Collapse::Children children = collapse_.children(binary);
    for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
      if (slot >= children.count) {
        node.children[slot] = first_leaf_;
      } else if (collapse_.is_leaf(children.node[slot])) {
        const std::uint32_t count = count_triangles(children.node[slot]);
        node.children[slot] = ChildLink::leaf(static_cast<std::uint32_t>(next.triangles), count);
        write_triangles(children.node[slot], ids_of(leaves_.data(), node.children[slot]));
        next.triangles += count;
        below[slot] = prospect_of_leaf(count);
      } else {
        node.children[slot] = ChildLink::node(0);  // numbered later
      }
    }
    return children;
  }

  // Calls `visit` with the leaves of a node. The first slot with an empty box ends its children.
  template <class Visit>
  void for_leaves(const Node& node, const Visit& visit) const {
    const auto& [lower, upper] = node.planes[0];
    for (std::uint32_t slot = 0; slot < Node::width && lower[slot] <= upper[slot]; ++slot) {
      if (node.children[slot].is_leaf()) visit(node.children[slot]);
    }
  }

  // Triangles are scattered in memory, and so are their corners: both are prefetched, one and two nodes
  // ahead.
  void write_leaves(std::size_t begin, std::size_t end) const {
    for (std::size_t i = begin; i < end + 2; ++i) {
      if (i < end) {
        for_leaves(nodes_[i], [&](ChildLink leaf) { prefetch_indices(leaf); });
      }
      if (i >= begin + 1 && i - 1 < end) {
        for_leaves(nodes_[i - 1], [&](ChildLink leaf) { prefetch_corners(leaf); });
      }
      if (i >= begin + 2) {
        for_leaves(nodes_[i - 2], [&](ChildLink leaf) { write_vertices(geometry_, leaf, leaves_.data()); });
      }
    }
  }

  void prefetch_indices(ChildLink leaf) const {
    const std::uint32_t* ids = ids_of(leaves_.data(), leaf);
    for (std::uint32_t i = 0; i < leaf.count(); ++i) geometry_.prefetch_indices(ids[i]);
  }
  void prefetch_corners(ChildLink leaf) const {
    const std::uint32_t* ids = ids_of(leaves_.data(), leaf);
    for (std::uint32_t i = 0; i < leaf.count(); ++i) geometry_.prefetch_corners(ids[i]);
  }

  const Geometry& geometry_;
  const BinaryTree& tree_;
  const Target target_;
  const Collapse& collapse_;
  std::vector<Section> sections_;
  Extent total_;
  std::uint32_t depth_ = 0;
  AlignedArray<Node> nodes_;
  AlignedArray<std::uint32_t> leaves_;
  ChildLink first_leaf_;
};

}  // namespace

LaidOut make_wide_bvh(const Geometry& geometry, const BinaryTree& tree, std::uint32_t width) {
  if (tree.empty()) return {};
  const Target target = choose_target();
  const Collapse collapse(tree, width, {}, target);
  return with_width(
      width, [&](auto w) { return LayoutWriter<WideNode<w>>(geometry, tree, target, collapse).write(); });
}

std::size_t layout_memory_bound(std::size_t references) {
  // A subtree of up to eight references is always cheapest as a leaf, so that a wide node has more than eight
  // below it. A wide node of width w and its parent have at least w + 2 children together, or the parent
  // would have taken those of the node. So at most one child in w / 2 + 1 is a node: there are twice as many
  // nodes of half the width and half the size.
  static_assert(max_node_width == 16 && wide_leaf_triangles == 8);
  const std::size_t nodes = references / 8 + 1;
  // A section is the child of a node of at least 2^(large_bits - 1) references.
  const std::size_t sections = 1 + max_node_width * max_tree_depth * (references >> (large_bits - 1));
  return nodes * sizeof(WideNode<max_node_width>) +
         (words_per_triangle * references + leaf_padding_words) * sizeof(std::uint32_t) +
         Collapse::bytes(2 * references) + 2 * sections * sizeof(Section);  // vectors grow by doubling
}

}  // namespace kerf
