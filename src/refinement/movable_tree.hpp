// A binary tree whose subtrees can be moved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/box3f.hpp"
#include "refinement/ray_flux.hpp"
#include "tree/binary_tree.hpp"

namespace kerf {

/// What a tree needs to know of itself while subtrees are moved: parents, heights, numbers of references and
/// what boxes measure: half their areas, or the rays that meet them.
/// Every node keeps its sibling beside it; that children come after their parents is given up, and
/// `number_depth_first` restores it.
class MovableTree {
 public:
  /// `tree` must not be empty. It must outlive this, and so must `flux`, which may be null.
  explicit MovableTree(BinaryTree& tree, const RayFlux* flux = nullptr);

  const BinaryNode& node(std::uint32_t n) const { return tree_.nodes[n]; }
  const Box3f& box(std::uint32_t n) const { return tree_.nodes[n].bounds; }
  float measure(const Box3f& box) const { return flux_ != nullptr ? (*flux_)(box) : half_area(box); }
  float measure_of(std::uint32_t n) const { return flux_ != nullptr ? measures_[n] : half_area(box(n)); }
  std::uint32_t node_count() const { return static_cast<std::uint32_t>(tree_.nodes.size()); }
  std::uint32_t references(std::uint32_t n) const { return references_[n]; }  ///< below the node

  /// Not of the root, which has none of the two.
  std::uint32_t parent(std::uint32_t n) const { return parents_[pair_of(n)]; }
  std::uint32_t sibling(std::uint32_t n) const { return ((n - 1) ^ 1) + 1; }

  bool is_below(std::uint32_t n, std::uint32_t ancestor) const;

  /// Whether `n` may be moved beside `target`: neither is the root, `n` is no child of the root, `target` is
  /// neither its parent nor its sibling, nor lies below it, and no leaf comes to lie deeper than
  /// `max_tree_depth`.
  bool can_move(std::uint32_t n, std::uint32_t target) const;

  /// Moves `n`, with all that is below it, beside what stands at `target`. The sibling takes the place of the
  /// parent, a new inner node that of the target:
  ///
  ///       parent       target                    sibling       inner
  ///        /   \          |           ->            |          /   \ .
  ///       n   sibling     x                        ...        x     n
  ///
  /// Returns where the parent stood: `move(node(target).right(), place)` undoes the move, but for the order
  /// of the siblings. All boxes above are fitted.
  std::uint32_t move(std::uint32_t n, std::uint32_t target);

  static constexpr std::size_t bytes(std::size_t nodes, bool has_flux) {
    return nodes * (sizeof(std::uint32_t) + sizeof(std::uint32_t) / 2 + 1 + (has_flux ? sizeof(float) : 0));
  }

 private:
  // Node 0 is the root; 1 and 2, 3 and 4, ... are pairs of siblings.
  static std::uint32_t pair_of(std::uint32_t n) { return (n - 1) / 2; }

  std::uint32_t depth(std::uint32_t n) const;
  void put(std::uint32_t place, const BinaryNode& content, float measure);
  void summarize(std::uint32_t n);
  void fit_upwards(std::uint32_t n);

  BinaryTree& tree_;
  const RayFlux* flux_;
  std::vector<std::uint32_t> parents_;     // of each pair
  std::vector<std::uint32_t> references_;  // of each node
  std::vector<std::uint8_t> heights_;      // of each node: of a leaf 0
  std::vector<float> measures_;            // of each node, by the flux
};

/// Numbers the nodes as builders do: depth first, left before right, children side by side. The references
/// come in the order of the leaves. Holds a second copy of the tree meanwhile.
void number_depth_first(BinaryTree& tree);

}  // namespace kerf
