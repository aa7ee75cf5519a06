#include "tree/measures/counts.hpp"

#include <algorithm>

namespace kerf {

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

}  // namespace kerf
