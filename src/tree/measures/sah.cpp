#include <algorithm>

#include "tree/measures/measures.hpp"

namespace kerf {
namespace {

// In double precision: the squares of extents near the float range overflow in single precision.
double half_area_double(const Box3f& box) {
  const double x = double{box.upper.x} - box.lower.x;
  const double y = double{box.upper.y} - box.lower.y;
  const double z = double{box.upper.z} - box.lower.z;
  return x * (y + z) + y * z;
}

}  // namespace

TreeCounts count_tree(const BinaryTree& tree) {
  TreeCounts counts;
  counts.nodes = tree.nodes.size();
  counts.references = tree.references.size();
  std::vector<std::size_t> depths(tree.nodes.size(), 0);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {  // parents come before their children
    const BinaryNode& node = tree.nodes[i];
    if (node.is_leaf()) {
      ++counts.leaves;
      counts.depth = std::max(counts.depth, depths[i]);
      if (counts.leaf_sizes.size() <= node.count) counts.leaf_sizes.resize(node.count + 1);
      ++counts.leaf_sizes[node.count];
    } else {
      depths[node.left()] = depths[node.right()] = depths[i] + 1;
    }
  }
  return counts;
}

double surface_area_cost(const BinaryTree& tree) {
  if (tree.empty()) return 0.0;
  double inner = 0.0, leaves = 0.0;
  for (const BinaryNode& node : tree.nodes) {
    const double area = half_area_double(node.bounds);
    if (node.is_leaf()) {
      leaves += area * node.count;
    } else {
      inner += area;
    }
  }
  const double root = half_area_double(tree.nodes[0].bounds);
  return root > 0.0 ? (inner_node_cost * inner + triangle_cost * leaves) / root : 0.0;
}

}  // namespace kerf
