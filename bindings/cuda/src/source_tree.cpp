#include "source_tree.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "sort_by_key.hpp"

namespace kerf::cuda {
namespace {

Box3f merge(const Box3f& a, const Box3f& b) {
  Box3f box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::min(a.lower[axis], b.lower[axis]);
    box.upper[axis] = std::max(a.upper[axis], b.upper[axis]);
  }
  return box;
}

double half_area(const Box3f& box) {
  if (box.empty()) return 0.0;
  const double x = double{box.upper.x} - box.lower.x, y = double{box.upper.y} - box.lower.y,
               z = double{box.upper.z} - box.lower.z;
  return x * (y + z) + y * z;
}

// Of the part of a triangle that the leaf was made for, as far as that is known: what its box and the leaf's
// share.
Box3f box_in(const SourceTriangle& triangle, const Box3f& leaf) {
  Box3f box;
  for (const Vec3f& corner : triangle.corner) box = merge(box, Box3f{corner, corner});
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::max(box.lower[axis], leaf.lower[axis]);
    box.upper[axis] = std::min(box.upper[axis], leaf.upper[axis]);
  }
  return box;
}

class Splitter {
 public:
  Splitter(SourceTree& tree, std::uint32_t max_leaf_size) : tree_(tree), max_leaf_size_(max_leaf_size) {}

  // Splits leaf `number` until its parts are small enough.
  void split(std::uint32_t number) {
    const SourceNode leaf = tree_.nodes[number];
    if (leaf.count <= max_leaf_size_) return;
    const std::uint32_t left_count = arrange(leaf);
    const auto left = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes[number].first = left;
    tree_.nodes[number].count = 0;
    tree_.nodes.push_back(part(leaf, 0, left_count));
    tree_.nodes.push_back(part(leaf, left_count, leaf.count - left_count));
    split(left);
    split(left + 1);
  }

 private:
  SourceNode part(const SourceNode& leaf, std::uint32_t begin, std::uint32_t count) const {
    SourceNode node{.box = {}, .first = leaf.first + begin, .count = count};
    for (std::uint32_t i = 0; i < count; ++i)
      node.box = merge(node.box, box_in(tree_.references[node.first + i], leaf.box));
    return node;
  }

  // Orders the leaf's references along the axis of the cheapest split, and says how many come to the left.
  std::uint32_t arrange(const SourceNode& leaf) {
    const auto begin = tree_.references.begin() + leaf.first;
    std::vector<SourceTriangle> best_order;
    std::uint32_t best_count = leaf.count / 2;
    double best_cost = std::numeric_limits<double>::infinity();
    std::vector<SourceTriangle> order(begin, begin + leaf.count);
    for (int axis = 0; axis < 3; ++axis) {
      sort_by_key(order, [&](const SourceTriangle& triangle) {
        const Box3f box = box_in(triangle, leaf.box);
        return double{box.lower[axis]} + box.upper[axis];
      });
      std::vector<double> right_area(leaf.count);
      Box3f box;
      for (std::uint32_t i = leaf.count; i-- > 1;) {
        box = merge(box, box_in(order[i], leaf.box));
        right_area[i] = half_area(box);
      }
      box = {};
      for (std::uint32_t i = 1; i < leaf.count; ++i) {
        box = merge(box, box_in(order[i - 1], leaf.box));
        const double cost = half_area(box) * i + right_area[i] * (leaf.count - i);
        if (cost >= best_cost) continue;
        best_cost = cost;
        best_count = i;
        best_order = order;
      }
    }
    if (!best_order.empty()) std::copy(best_order.begin(), best_order.end(), begin);
    return best_count;
  }

  SourceTree& tree_;
  std::uint32_t max_leaf_size_;
};

}  // namespace

SourceTree with_small_leaves(SourceTree tree, std::uint32_t max_leaf_size) {
  Splitter splitter(tree, max_leaf_size);
  const auto count = static_cast<std::uint32_t>(tree.nodes.size());
  for (std::uint32_t i = 0; i < count; ++i)
    if (tree.nodes[i].count > max_leaf_size) splitter.split(i);
  return tree;
}

}  // namespace kerf::cuda
