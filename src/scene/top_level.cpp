#include "scene/top_level.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/aligned_array.hpp"
#include "base/parallel.hpp"
#include "base/uninitialized.hpp"
#include "construction/sbvh/subtree.hpp"
#include "layout/child_order.hpp"
#include "layout/collapse.hpp"
#include "math/box3f.hpp"

namespace kerf {
namespace {

// References are split until so few are together. What is in one wide node needs no order: with as many as a
// node has slots, builds take a seventh less and rays are up to 5 % slower (docs/decisions/0110).
constexpr std::uint32_t cluster_size(std::uint32_t width) {
  return width / 2;
}

// Nodes of more references than this are split, and wide nodes over more written, by several tasks.
constexpr std::uint32_t max_serial_split = 1024, max_serial_write = 2048;

// A half of so few references is no task of its own.
constexpr std::uint32_t min_parallel = 128;

constexpr std::size_t measuring_block = 8192;

// A node of a binary tree whose leaves are clusters.
struct Split {
  Box3f box;
  std::uint32_t first, count;  // references
  std::uint32_t children;      // the first of two; 0 for a cluster, as the root is nobody's child
  std::uint64_t left_shares;   // four bits for each number of slots

  // Of so many slots, those of the left child; 0 where they are no better than one fewer.
  std::uint32_t left_share(std::uint32_t slots) const {
    return static_cast<std::uint32_t>(left_shares >> (4 * (slots - 1))) & 15u;
  }
  void set_left_share(std::uint32_t slots, std::int32_t share) {
    left_shares |= static_cast<std::uint64_t>(share) << (4 * (slots - 1));
  }
};

// Numbers of splits are handed out in pairs, for siblings; to a task so many at a time, so that no two tasks
// write to one cache line.
constexpr std::uint32_t splits_per_block = 64;

class SplitNumbers {
 public:
  explicit SplitNumbers(std::atomic<std::uint32_t>& shared) : shared_(shared) {}
  std::uint32_t take() {
    if (next_ == end_) {
      next_ = shared_.fetch_add(splits_per_block, std::memory_order_relaxed);
      end_ = next_ + splits_per_block;
    }
    next_ += 2;
    return next_ - 2;
  }

 private:
  std::atomic<std::uint32_t>& shared_;
  std::uint32_t next_ = 0, end_ = 0;
};

// What is to become a child of a wide node.
struct Child {
  Box3f box;
  std::uint32_t first, count;  // references
  std::uint32_t split;         // if they are several
};

template <class Node>
struct Children {
  std::array<Child, Node::width> of;
  std::uint32_t count = 0;
};

// A wide node with few references, which is written with all that is below it by one task.
struct Subtree {
  std::uint32_t split, depth, first_leaf;  // of its root; that of the tree has a depth of 1
  std::uint32_t nodes = 0, max_depth = 0;
  std::uint32_t first_node = 0;
  Prospect prospect{};
};

// Splits references by the surface-area heuristic, and collapses the binary tree as `Collapse` does it. Here
// a leaf of the binary tree, a cluster, takes one slot and is a wide node then, or a slot for each of its
// references, and costs nothing.
template <class Node>
class TopLevelBuilder {
 public:
  TopLevelBuilder(std::span<Reference> references, std::uint32_t* primitives, Target target)
      : references_(references),
        primitives_(primitives),
        context_{.arena = references.data(), .max_leaf_size = 1, .target = target},
        distribute_(distribute(Node::width, target)),
        splits_(2 * references.size() + references.size() / 2 + splits_per_block) {}

  WideBvh build() {
    struct Extent {
      Box3f box, doubled_centroids;
      Extent operator+(const Extent& other) const {
        return {merge(box, other.box), merge(doubled_centroids, other.doubled_centroids)};
      }
    };
    const auto count = static_cast<std::uint32_t>(references_.size());
    const auto extent = parallel_sum<Extent>(count, measuring_block, [&](const auto& range) {
      Extent sum;
      for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
        const Reference& reference = references_[i];
        sum.box = merge(sum.box, reference.bounds());
        sum.doubled_centroids = merge(sum.doubled_centroids, reference.lower + reference.upper);
      }
      return sum;
    });
    Costs costs;
    SplitNumbers numbers(next_split_);
    solve(numbers.take(), {{0, count, count}, 0, extent.box, extent.doubled_centroids}, numbers, costs);
    find_subtrees(0, 1, 0);
    parallel_for(subtrees_.size(),
                 [&](std::size_t i) { measure(subtrees_[i].split, subtrees_[i].depth, subtrees_[i]); });
    std::uint32_t node_count = nodes_above_, depth = 0;
    for (Subtree& subtree : subtrees_) {
      subtree.first_node = node_count;
      node_count += subtree.nodes;
      depth = std::max(depth, subtree.max_depth);
    }
    const AlignedArray<Node> nodes(node_count);
    nodes_ = nodes.data();
    parallel_for(subtrees_.size(), [&](std::size_t i) {
      Subtree& subtree = subtrees_[i];
      Places next{subtree.first_node, subtree.first_leaf};
      subtree.prospect = write_below(subtree.split, next);
    });
    Places next{0, 0};
    const Subtree* subtree = subtrees_.data();
    if (nodes_above_ != 0) write_above(0, next, subtree);
    return {.width = Node::width,
            .node_count = node_count,
            .node_data = nodes_,
            .leaves = {},
            .bounds = extent.box,
            .largest_coordinate = largest_coordinate(extent.box),
            .depth = depth,
            .node_memory = nodes.owner(),
            .leaf_memory = nullptr};
  }

 private:
  using Costs = std::array<float, max_node_width>;

  // Splits a node and all below it. `costs[i - 1]` becomes the minimum of what it costs in i slots.
  void solve(std::uint32_t number, const NodeInput& node, SplitNumbers& numbers, Costs& costs) {
    const std::uint32_t count = node.range.count();
    const float area = half_area(node.box);
    Split& split = splits_[number];
    split = {node.box, node.range.begin, count, 0, 0};
    if (count <= cluster_size(Node::width)) {
      for (std::uint32_t i = 0; i < Node::width; ++i) costs[i] = i + 1 < count ? area : 0.0f;
      return;
    }
    const std::uint32_t left = numbers.take(), right = left + 1;
    split.children = left;
    NodeInput left_node, right_node;
    split_node(context_, node, left_node, right_node);
    Costs left_costs, right_costs;
    const auto solve_left = [&](SplitNumbers& own) { solve(left, left_node, own, left_costs); };
    const auto solve_right = [&](SplitNumbers& own) { solve(right, right_node, own, right_costs); };
    if (count > max_serial_split &&
        std::min(left_node.range.count(), right_node.range.count()) > min_parallel) {
      SplitNumbers others(next_split_);
      parallel_invoke([&] { solve_left(numbers); }, [&] { solve_right(others); });
    } else {
      solve_left(numbers);
      solve_right(numbers);
    }
    Distribution best;
    const std::uint32_t max_share = std::min(Node::width - 1, left_node.range.count());
    distribute_(left_costs.data(), static_cast<std::int32_t>(max_share), right_costs.data(), best);
    float min_cost = area + best.cost[Node::width - 1];
    costs[0] = min_cost;
    split.set_left_share(Node::width, best.left_share[Node::width - 1]);
    for (std::uint32_t slots = 2; slots < Node::width; ++slots) {
      if (best.cost[slots - 1] < min_cost) {
        min_cost = best.cost[slots - 1];
        split.set_left_share(slots, best.left_share[slots - 1]);
      }
      costs[slots - 1] = min_cost;
    }
  }

  Children<Node> children_of(std::uint32_t number) const {
    Children<Node> children;
    expand(number, Node::width, children);
    return children;
  }

  void expand(std::uint32_t number, std::uint32_t slots, Children<Node>& children) const {
    while (true) {
      const Split& split = splits_[number];
      const bool is_cluster = split.children == 0;
      if (is_cluster && split.count <= slots) {
        for (std::uint32_t i = split.first; i < split.first + split.count; ++i)
          children.of[children.count++] = {references_[i].bounds(), i, 1, 0};
        return;
      }
      if (is_cluster || slots == 1) {
        children.of[children.count++] = {split.box, split.first, split.count, number};
        return;
      }
      const std::uint32_t left_share = split.left_share(slots);
      if (left_share == 0) {
        --slots;
        continue;
      }
      expand(split.children, left_share, children);
      number = split.children + 1;
      slots -= left_share;
    }
  }

  // The nodes above the subtrees come first, then those of one subtree after another.
  void find_subtrees(std::uint32_t split, std::uint32_t depth, std::uint32_t first_leaf) {
    if (splits_[split].count <= max_serial_write) {
      subtrees_.push_back({split, depth, first_leaf});
      return;
    }
    ++nodes_above_;
    const Children<Node> children = children_of(split);
    std::uint32_t next_leaf = first_leaf;
    for (std::uint32_t i = 0; i < children.count; ++i)
      if (children.of[i].count == 1) ++next_leaf;
    for (std::uint32_t i = 0; i < children.count; ++i) {
      if (children.of[i].count == 1) continue;
      find_subtrees(children.of[i].split, depth + 1, next_leaf);
      next_leaf += children.of[i].count;
    }
  }

  void measure(std::uint32_t split, std::uint32_t depth, Subtree& subtree) const {
    ++subtree.nodes;
    subtree.max_depth = std::max(subtree.max_depth, depth);
    const Children<Node> children = children_of(split);
    for (std::uint32_t i = 0; i < children.count; ++i)
      if (children.of[i].count > 1) measure(children.of[i].split, depth + 1, subtree);
  }

  // The numbers of the next node and of the next leaf.
  struct Places {
    std::uint32_t node, leaf;
  };

  Prospect write_below(std::uint32_t split, Places& next) const {
    return write(split, next, [&](std::uint32_t child) {
      const std::uint32_t number = next.node;
      return std::pair(number, write_below(child, next));
    });
  }

  Prospect write_above(std::uint32_t split, Places& next, const Subtree*& subtree) const {
    return write(split, next, [&](std::uint32_t child) {
      if (splits_[child].count <= max_serial_write) {
        const Subtree& written = *subtree++;
        next.leaf += splits_[child].count;
        return std::pair(written.first_node, written.prospect);
      }
      const std::uint32_t number = next.node;
      return std::pair(number, write_above(child, next, subtree));
    });
  }

  // Writes a node and its leaves, and what is below it by `write_child(split)`, which returns the number of
  // that node and its prospect.
  template <class WriteChild>
  Prospect write(std::uint32_t split, Places& next, const WriteChild& write_child) const {
    Node& node = nodes_[next.node++];
    const Children<Node> children = children_of(split);
    std::array<Prospect, max_node_width> prospects;
    std::array<BinaryNode, Node::width> boxes;
    std::array<const BinaryNode*, Node::width> pointers;
    for (std::uint32_t i = 0; i < children.count; ++i) {
      const Child& child = children.of[i];
      boxes[i].bounds = child.box;
      pointers[i] = &boxes[i];
      if (child.count != 1) continue;
      primitives_[next.leaf] = references_[child.first].primitive;
      node.children[i] = ChildLink::leaf(next.leaf++, 1);
      prospects[i] = prospect_of_leaf(1);
    }
    for (std::uint32_t i = 0; i < children.count; ++i) {
      if (children.of[i].count == 1) continue;
      const auto [number, prospect] = write_child(children.of[i].split);
      node.children[i] = ChildLink::node(number);
      prospects[i] = prospect;
    }
    std::fill(node.children + children.count, node.children + Node::width, ChildLink::leaf(0, 1));
    return arrange(context_.target, {pointers.data(), children.count}, prospects, node);
  }

  const std::span<Reference> references_;
  std::uint32_t* const primitives_;
  const BuildContext context_;
  Distribute& distribute_;
  UninitializedVector<Split> splits_;
  std::atomic<std::uint32_t> next_split_ = 0;
  std::vector<Subtree> subtrees_;
  std::uint32_t nodes_above_ = 0;
  Node* nodes_ = nullptr;
};

}  // namespace

WideBvh build_top_level(std::span<Reference> references, std::uint32_t* primitives, std::uint32_t width,
                        Target target) {
  if (references.empty()) return {};
  return with_width(
      width, [&](auto w) { return TopLevelBuilder<WideNode<w>>(references, primitives, target).build(); });
}

}  // namespace kerf
