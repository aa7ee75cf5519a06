// Walking all leaves whose boxes pass a test, in any order.
#pragma once

#include <array>
#include <cstddef>
#include <memory_resource>
#include <vector>

#include "query/tree_view.hpp"

namespace kerf {

/// Calls `visit(id, triangle)` for each reference in a leaf of which every box from the root down satisfies
/// `enter`. A triangle with several references is visited for each of them.
template <class Enter, class Visit>
void for_each_leaf(const TreeView& tree, Enter&& enter, Visit&& visit) {
  if (tree.empty() || !enter(tree.bounds())) return;
  std::array<std::byte, 2048> stack;
  std::pmr::monotonic_buffer_resource memory(stack.data(), stack.size());
  std::pmr::vector<TreeView::Node> waiting(&memory);
  waiting.reserve(stack.size() / sizeof(TreeView::Node) - 1);
  waiting.push_back(tree.root());
  while (!waiting.empty()) {
    const TreeView::Node node = waiting.back();
    waiting.pop_back();
    if (tree.is_leaf(node)) {
      tree.for_each_triangle(node, visit);
    } else {
      tree.for_each_child(node, [&](TreeView::Node child, const Box3f& box) {
        if (enter(box)) waiting.push_back(child);
      });
    }
  }
}

}  // namespace kerf
