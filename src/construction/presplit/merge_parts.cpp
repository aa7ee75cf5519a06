#include "construction/presplit/merge_parts.hpp"

#include <algorithm>
#include <utility>

namespace kerf {

void merge_parts_in_leaves(BinaryTree& tree) {
  UninitializedVector<std::uint32_t> kept;
  kept.reserve(tree.references.size());
  for (BinaryNode& node : tree.nodes) {
    if (!node.is_leaf()) continue;
    const auto first = static_cast<std::ptrdiff_t>(kept.size());
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const std::uint32_t id = tree.references[i];
      if (std::find(kept.begin() + first, kept.end(), id) == kept.end()) kept.push_back(id);
    }
    node.first = static_cast<std::uint32_t>(first);
    node.count = static_cast<std::uint32_t>(kept.size()) - node.first;
  }
  tree.references = std::move(kept);
}

}  // namespace kerf
