#include "layout/refit.hpp"

#include <atomic>
#include <bit>
#include <optional>

#include "base/parallel.hpp"
#include "layout/collapse.hpp"
#include "layout/move_leaves.hpp"
#include "layout/wide_children.hpp"

namespace kerf {
namespace {

constexpr std::uint32_t nodes_per_block = 64;

// In the row of triangle numbers, which are below 2^31: this one has no area.
constexpr std::uint32_t flat_bit = 1u << 31;

std::uint32_t* words_of(const WideBvh& wide, ChildLink leaf) {
  return const_cast<std::uint32_t*>(wide.leaves.data()) + words_per_triangle * leaf.first();
}
std::uint32_t& id_in(const WideBvh& wide, ChildLink leaf, std::uint32_t i) {
  return words_of(wide, leaf)[(words_per_triangle - 1) * leaf.count() + i];
}

void write_triangle(const WideBvh& wide, ChildLink leaf, std::uint32_t i, const Triangle& triangle) {
  std::uint32_t* word = words_of(wide, leaf) + i;
  for (const Vec3f* vertex : {&triangle.v0, &triangle.v1, &triangle.v2}) {
    for (int axis = 0; axis < 3; ++axis, word += leaf.count())
      *word = std::bit_cast<std::uint32_t>((*vertex)[axis]);
  }
}

template <class Node>
class Refit {
 public:
  Refit(const RefitBasis& basis, const Geometry& geometry, Target target, WideBvh& wide)
      : basis_(basis),
        geometry_(geometry),
        target_(target),
        wide_(wide),
        nodes_(const_cast<Node*>(wide.nodes<Node>())),
        boxes_(wide.node_count) {}

  // Moves the triangles of all leaves, and sets the boxes of the leaves. Returns whether all have an area;
  // those that have none are marked.
  bool move_leaves() {
    std::atomic<bool> all_have_area = true;
    for_blocks([&](std::uint32_t begin, std::uint32_t end) {
      // The places in nodes of leaves that are moved together.
      struct Slot {
        std::uint32_t node, slot;
      };
      Slot slots[max_leaves_moved];
      ChildLink leaves[max_leaves_moved];
      MovedLeaf moved[max_leaves_moved];
      std::uint32_t count = 0;
      for (std::uint32_t n = begin; n < end; ++n) {
        for_leaves(n, [&](ChildLink leaf, std::uint32_t slot) {
          slots[count] = {n, slot};
          leaves[count++] = leaf;
        });
        if (n + 1 < end && count + Node::width <= max_leaves_moved) continue;
        kerf::move_leaves(target_, basis_.pieces, geometry_, wide_, {leaves, count}, moved);
        for (std::uint32_t i = 0; i < count; ++i) {
          if (!moved[i].box.empty()) set_box(nodes_[slots[i].node], slots[i].slot, moved[i].box);
          if (moved[i].flat == 0) continue;
          mark(leaves[i], moved[i].flat);
          all_have_area = false;
        }
        count = 0;
      }
    });
    return all_have_area;
  }

  // Puts a triangle with an area into the places of those that are marked. False if there is none.
  bool replace_flat_triangles(std::vector<StandIn>& stand_ins) {
    std::optional<Triangle> other;
    std::uint32_t other_id = 0;
    for_all_leaves([&](ChildLink leaf, Node&, std::uint32_t) {
      for (std::uint32_t i = 0; i < leaf.count(); ++i) {
        const std::uint32_t id = triangle_id(wide_, leaf, i);
        if ((id & flat_bit) != 0) {
          stand_ins.push_back({leaf, i, id & ~flat_bit});
        } else if (!other) {
          other = triangle_in(wide_, leaf, i);
          other_id = id;
        }
      }
    });
    if (!other) return false;
    for_all_leaves([&](ChildLink leaf, Node& node, std::uint32_t slot) {
      std::uint32_t flat = 0;
      for (std::uint32_t i = 0; i < leaf.count(); ++i) {
        if ((triangle_id(wide_, leaf, i) & flat_bit) == 0) continue;
        write_triangle(wide_, leaf, i, *other);
        id_in(wide_, leaf, i) = other_id;
        ++flat;
      }
      // A box that is empty would say that the slot is not used.
      if (flat == leaf.count()) set_box(node, slot, merge(Box3f{}, other->v0));
    });
    return true;
  }

  // The boxes of nodes, from the lowest up: children come after their parents.
  void merge_boxes() {
    for (std::uint32_t n = wide_.node_count; n-- > 0;) {
      Node& node = nodes_[n];
      for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
        if (child_box(node, slot).empty()) continue;
        if (!node.children[slot].is_leaf()) set_box(node, slot, boxes_[node.children[slot].node()]);
        boxes_[n] = merge(boxes_[n], child_box(node, slot));
      }
    }
    wide_.bounds = boxes_[0];
    wide_.largest_coordinate = largest_coordinate(boxes_[0]);
  }

  // Where children lie has changed, and so has their order from near to far.
  void order_children() {
    for_blocks([&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t n = begin; n < end; ++n) {
        BinaryNode children[Node::width];
        const BinaryNode* in_slots[Node::width];
        std::uint32_t count = 0;
        for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
          children[slot].bounds = child_box(nodes_[n], slot);
          in_slots[slot] = &children[slot];
          if (!children[slot].bounds.empty()) count = slot + 1;
        }
        write_children(target_, in_slots, count, nodes_[n]);
      }
    });
  }

 private:
  template <class Body>
  void for_blocks(const Body& body) const {
    parallel_for_ranges(0u, wide_.node_count, nodes_per_block,
                        [&](const auto& range) { body(range.begin(), range.end()); });
  }

  // Calls `visit(leaf, node, slot)` for all leaves.
  template <class Visit>
  void for_all_leaves(const Visit& visit) const {
    for (std::uint32_t n = 0; n < wide_.node_count; ++n)
      for_leaves(n, [&](ChildLink leaf, std::uint32_t slot) { visit(leaf, nodes_[n], slot); });
  }

  // Calls `visit(leaf, slot)` for the leaves of a node.
  template <class Visit>
  void for_leaves(std::uint32_t n, const Visit& visit) const {
    const Node& node = nodes_[n];
    for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
      const ChildLink child = node.children[slot];
      if (child.is_leaf() && node.planes[0][0][slot] <= node.planes[0][1][slot]) visit(child, slot);
    }
  }

  void mark(ChildLink leaf, std::uint32_t flat) const {
    for (std::uint32_t i = 0; i < leaf.count(); ++i)
      if ((flat >> i & 1) != 0) id_in(wide_, leaf, i) |= flat_bit;
  }

  static void set_box(Node& node, std::uint32_t slot, const Box3f& box) {
    for (int axis = 0; axis < 3; ++axis) {
      node.planes[axis][0][slot] = box.lower[axis];
      node.planes[axis][1][slot] = box.upper[axis];
    }
  }

  const RefitBasis& basis_;
  const Geometry& geometry_;
  const Target target_;
  WideBvh& wide_;
  Node* const nodes_;
  std::vector<Box3f> boxes_;  // of each node
};

}  // namespace

bool leaves_are_apart(const WideBvh& wide) {
  std::vector<bool> taken(wide.references());
  bool apart = true;
  for_each_leaf(wide, [&](ChildLink leaf) {
    for (std::uint32_t i = leaf.first(); i < leaf.first() + leaf.count(); ++i) {
      apart = apart && !taken[i];
      taken[i] = true;
    }
  });
  return apart;
}

RefitBasis make_refit_basis(const WideBvh& wide, std::size_t triangles) {
  RefitBasis basis;
  std::vector<bool> met(triangles);
  for_each_leaf(wide, [&](ChildLink leaf) {
    for (std::uint32_t i = 0; i < leaf.count(); ++i) met[triangle_id(wide, leaf, i)] = true;
  });
  for (std::uint32_t id = 0; id < triangles; ++id)
    if (!met[id]) basis.left_out.push_back(id);
  basis.pieces = Pieces(wide, triangles);
  basis.cost = traversal_cost(wide);
  return basis;
}

bool refit(const RefitBasis& basis, const Geometry& geometry, Target target, WideBvh& wide,
           std::vector<StandIn>& stand_ins) {
  return with_width(wide.width, [&](auto width) {
    Refit<WideNode<width>> refit(basis, geometry, target, wide);
    for (const auto& [leaf, i, id] : stand_ins) id_in(wide, leaf, i) = id;
    stand_ins.clear();
    if (!refit.move_leaves() && !refit.replace_flat_triangles(stand_ins)) return false;
    refit.merge_boxes();
    refit.order_children();
    return true;
  });
}

double traversal_cost(const WideBvh& wide) {
  constexpr CollapseCosts costs;
  const auto half_area = [](const Box3f& box) {  // that of floats may overflow
    if (box.empty()) return 0.0;
    const Vec3d e = difference(box.upper, box.lower);
    return e.x * (e.y + e.z) + e.y * e.z;
  };
  const double all = half_area(wide.bounds);
  const double sum = with_width(wide.width, [&](auto width) {
    const auto* const nodes = wide.nodes<WideNode<width>>();
    return parallel_sum<double>(wide.node_count, nodes_per_block, [&](const auto& range) {
      double of_nodes = 0.0;
      for (std::uint32_t n = range.begin(); n != range.end(); ++n) {
        for (std::uint32_t slot = 0; slot < width; ++slot) {
          const ChildLink child = nodes[n].children[slot];
          const double area = half_area(child_box(nodes[n], slot));
          of_nodes +=
              area * (child.is_leaf() ? double{costs.leaf} + double{costs.triangle} * child.count() : 1.0);
        }
      }
      return of_nodes;
    });
  });
  return 1.0 + (all > 0.0 ? sum / all : 0.0);
}

}  // namespace kerf
