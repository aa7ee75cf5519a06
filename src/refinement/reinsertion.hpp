// Better trees by moving subtrees to where they cost less.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "math/box3f.hpp"
#include "refinement/movable_tree.hpp"
#include "refinement/ray_flux.hpp"

namespace kerf {

/// What a tree is expected to cost once it is laid out, in measures of boxes (half areas, or the rays that
/// meet them): an inner node of more references than a leaf of the layout has counts once, and a leaf of the
/// layout, which is the largest subtree of no more, `leaf` times. What lies within such a leaf costs nothing,
/// since its triangles are tested together.
struct ReinsertionCosts {
  double leaf = 3.0;
};

/// Parallel reinsertion (Meister & Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy
/// Optimization"): for every subtree its best place is searched in the tree as it is; then the moves are made
/// one after another, those that promise most first. A move that does not pay any more is undone. The same
/// tree for any number of threads.
class Reinsertion {
 public:
  /// `tree` must not be empty and must outlive this, and so must `flux`, which measures boxes in place of
  /// half their areas if it is not null.
  explicit Reinsertion(BinaryTree& tree, const RayFlux* flux = nullptr, const ReinsertionCosts& costs = {});

  /// Tries to move every subtree, or only this fraction of them: those with the largest boxes. On all threads
  /// of the task arena that this is called in. Asks `may_go_on` after every few thousand searches, with the
  /// fraction of them that is done; after a false no more are begun. Returns by which part of what it was the
  /// cost has fallen.
  double improve(double fraction, const std::function<bool(double)>& may_go_on);

  /// The memory for a tree of so many nodes, that of the tree not counted.
  static constexpr std::size_t bytes(std::size_t nodes, double fraction, bool has_flux) {
    return MovableTree::bytes(nodes, has_flux) + nodes * sizeof(std::uint32_t) +
           static_cast<std::size_t>(fraction * static_cast<double>(nodes)) * sizeof(Move);
  }

 private:
  struct Move {
    float gain;  // in measures of inner nodes
    std::uint32_t node, target;
  };

  std::vector<std::uint32_t> largest(double fraction) const;
  Move find_best_place(std::uint32_t node) const;
  double make(const Move& move);
  bool is_inner(std::uint32_t node) const;
  double cost_at(std::uint32_t node) const;
  double cost_above(std::uint32_t a, std::uint32_t b);
  double cost() const;

  MovableTree tree_;
  ReinsertionCosts costs_;
  double cost_;
  std::vector<std::uint32_t> path_;
};

}  // namespace kerf
