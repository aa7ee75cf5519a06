#include "layout/change_width.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/raise.hpp"
#include "layout/lay_out.hpp"
#include "math/box3f.hpp"
#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {
namespace {

// What the children of a wide node are joined by.
enum class Join {
  smallest_area,  // the pair with the smallest box first
  lowest,         // the pair with the lowest subtrees first, which gives the lowest tree (Golumbic 1976)
};

// The binary nodes between a wide node and its children.
struct ChildTree {
  struct Member {
    Box3f box;
    std::uint32_t height;       // of the binary tree below
    std::uint32_t left, right;  // members; of a child of the wide node: its slot, twice
  };
  std::array<Member, 2 * max_node_width> members;
  std::uint32_t count = 0, root = 0;
};

template <class Node>
class Unfolding {
 public:
  Unfolding(const WideBvh& wide, Join join) : wide_(wide), join_(join), heights_(wide.node_count, none) {
    // Children come after their parents.
    for (std::uint32_t number = wide.node_count; number-- > 0;) {
      const ChildTree between = join_children(number);
      if (between.count != 0) heights_[number] = between.members[between.root].height;
    }
  }

  bool empty() const { return heights_[0] == none; }
  std::uint32_t height() const { return heights_[0]; }

  BinaryTree tree() const {
    BinaryTree tree;
    tree.nodes.push_back({});
    unfold(0, 0, tree);
    return tree;
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();  // no leaf below

  ChildTree join_children(std::uint32_t number) const {
    const Node& node = wide_.nodes<Node>()[number];
    ChildTree between;
    std::array<std::uint32_t, max_node_width> open;  // members without a parent
    std::uint32_t open_count = 0;
    for (std::uint32_t slot = 0; slot < Node::width; ++slot) {
      const Box3f box = child_box(node, slot);
      const ChildLink child = node.children[slot];
      const std::uint32_t height = child.is_leaf() ? 0 : heights_[child.node()];
      if (box.empty() || height == none) continue;
      open[open_count++] = between.count;
      between.members[between.count++] = {box, height, slot, slot};
    }
    while (open_count > 1) {
      const auto [i, j] = best_pair(between, open, open_count);
      const auto& a = between.members[open[i]];
      const auto& b = between.members[open[j]];
      between.members[between.count] = {merge(a.box, b.box), 1 + std::max(a.height, b.height), open[i],
                                        open[j]};
      open[i] = between.count++;
      open[j] = open[--open_count];
    }
    if (open_count == 1) between.root = open[0];
    return between;
  }

  // The first of the best, i < j.
  std::pair<std::uint32_t, std::uint32_t> best_pair(const ChildTree& between,
                                                    const std::array<std::uint32_t, max_node_width>& open,
                                                    std::uint32_t open_count) const {
    std::pair<std::uint32_t, std::uint32_t> best{0, 1};
    float best_cost = std::numeric_limits<float>::infinity();
    for (std::uint32_t j = 1; j < open_count; ++j) {
      for (std::uint32_t i = 0; i < j; ++i) {
        const auto& a = between.members[open[i]];
        const auto& b = between.members[open[j]];
        const float cost =
            join_ == Join::lowest ? static_cast<float>(a.height + b.height) : half_area(merge(a.box, b.box));
        if (cost < best_cost) {
          best_cost = cost;
          best = {i, j};
        }
      }
    }
    return best;
  }

  void unfold(std::uint32_t number, std::uint32_t place, BinaryTree& tree) const {
    const ChildTree between = join_children(number);
    unfold(number, between, between.root, place, tree);
  }

  void unfold(std::uint32_t number, const ChildTree& between, std::uint32_t member, std::uint32_t place,
              BinaryTree& tree) const {
    const auto& [box, height, left, right] = between.members[member];
    tree.nodes[place].bounds = box;
    if (left != right) {
      const auto first = static_cast<std::uint32_t>(tree.nodes.size());
      tree.nodes[place].first = first;
      tree.nodes.push_back({});
      tree.nodes.push_back({});
      unfold(number, between, left, first, tree);
      unfold(number, between, right, first + 1, tree);
      return;
    }
    const ChildLink child = wide_.nodes<Node>()[number].children[left];
    if (!child.is_leaf()) return unfold(child.node(), place, tree);
    tree.nodes[place].first = static_cast<std::uint32_t>(tree.references.size());
    tree.nodes[place].count = child.count();
    for (std::uint32_t i = 0; i < child.count(); ++i) tree.references.push_back(triangle_id(wide_, child, i));
  }

  const WideBvh& wide_;
  Join join_;
  std::vector<std::uint32_t> heights_;  // of the binary tree below each wide node
};

// Three vertices for each triangle that stands in a leaf.
std::vector<float> vertices_by_triangle(const WideBvh& wide, std::size_t triangles) {
  std::vector<float> vertices(9 * triangles);
  const auto copy = [&](const Triangle& triangle, float* to) {
    for (const Vec3f& v : {triangle.v0, triangle.v1, triangle.v2}) {
      for (int axis = 0; axis < 3; ++axis) *to++ = v[axis];
    }
  };
  for_each_leaf(wide, [&](ChildLink leaf) {
    for (std::uint32_t i = 0; i < leaf.count(); ++i)
      copy(triangle_in(wide, leaf, i), &vertices[9 * triangle_id(wide, leaf, i)]);
  });
  return vertices;
}

BinaryTree unfolded(const WideBvh& wide) {
  return with_width(wide.width, [&](auto width) {
    for (const Join join : {Join::smallest_area, Join::lowest}) {
      const Unfolding<WideNode<width>> unfolding(wide, join);
      if (unfolding.empty()) return BinaryTree{};
      if (unfolding.height() <= max_tree_depth) return unfolding.tree();
    }
    raise(Error::bad_format, "the hierarchy is deeper than any builder's");
  });
}

}  // namespace

WideBvh change_width(const WideBvh& wide, std::size_t triangles, std::uint32_t width) {
  if (wide.empty()) return wide;
  const BinaryTree tree = unfolded(wide);
  const std::vector<float> vertices = vertices_by_triangle(wide, triangles);
  std::vector<std::uint32_t> indices(3 * triangles);
  std::iota(indices.begin(), indices.end(), 0u);
  const TriangleMesh mesh{.vertices = vertices, .triangles = indices};
  WideBvh changed = make_wide_bvh(Geometry({&mesh, 1}), tree, width).wide;
  if (!changed.empty()) {
    changed.bounds = wide.bounds;
    changed.largest_coordinate = wide.largest_coordinate;
  }
  return changed;
}

}  // namespace kerf
