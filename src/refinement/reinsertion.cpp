#include "refinement/reinsertion.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include <kerf/layout.hpp>

#include "base/parallel.hpp"

namespace kerf {
namespace {

// A search ends after so many nodes. On average one visits 20 to 60; with twice or half the limit no tree
// that was measured costs more or less by a thousandth. Without it, boxes that all overlap would be searched
// n by n.
constexpr std::uint32_t max_visits = 256;

// Searches between two questions whether to go on, and those that one thread makes at a time.
constexpr std::size_t searches_per_batch = 16384;
constexpr std::size_t searches_per_task = 256;

}  // namespace

Reinsertion::Reinsertion(BinaryTree& tree, const RayFlux* flux, const ReinsertionCosts& costs)
    : tree_(tree, flux), costs_(costs), cost_(cost()) {}

double Reinsertion::improve(double fraction, const std::function<bool(double)>& may_go_on) {
  const std::vector<std::uint32_t> nodes = largest(fraction);
  std::vector<Move> moves(nodes.size());
  std::size_t searched = 0;
  while (searched < nodes.size()) {
    const std::size_t end = std::min(searched + searches_per_batch, nodes.size());
    parallel_for_ranges(searched, end, searches_per_task, [&](const IndexRange<std::size_t>& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) moves[i] = find_best_place(nodes[i]);
    });
    searched = end;
    if (!may_go_on(static_cast<double>(searched) / static_cast<double>(nodes.size()))) break;
  }
  moves.resize(searched);
  std::erase_if(moves, [](const Move& move) { return !(move.gain > 0.0f); });
  std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) {
    return a.gain != b.gain ? a.gain > b.gain : a.node < b.node;
  });
  const double before = cost_;
  for (const Move& move : moves) cost_ += make(move);
  return before > 0.0 ? (before - cost_) / before : 0.0;
}

std::vector<std::uint32_t> Reinsertion::largest(double fraction) const {
  std::vector<std::uint32_t> nodes(tree_.node_count() - 1);
  std::iota(nodes.begin(), nodes.end(), 1u);
  const auto count = static_cast<std::size_t>(fraction * static_cast<double>(nodes.size()));
  if (count >= nodes.size()) return nodes;
  std::nth_element(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(count), nodes.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float area_a = tree_.measure_of(a), area_b = tree_.measure_of(b);
                     return area_a != area_b ? area_a > area_b : a < b;
                   });
  nodes.resize(count);
  return nodes;
}

// Branch and bound over the whole tree, from the node's neighbourhood to the root (Meister & Bittner 2018,
// section 3.1). What a place gains is the area of the parent, which goes, and that by which the boxes above
// shrink, less what boxes on the way to the place grow and the area of the new inner node. Here all inner
// nodes count alike: which of them lie in a leaf of the layout changes with every move. `make` asks what a
// move is worth.
Reinsertion::Move Reinsertion::find_best_place(std::uint32_t node) const {
  Move best{0.0f, node, 0};
  const std::uint32_t parent = tree_.parent(node);
  if (parent == 0) return best;
  const Box3f& box = tree_.box(node);
  const float area = tree_.measure_of(node);

  struct Subtree {
    float gain;  // of what is done before its root is reached
    std::uint32_t root;
  };
  // A visit takes one subtree and adds two.
  std::array<Subtree, max_visits + 2> stack;
  std::uint32_t visits = 0;
  Box3f rest;  // of what lies below `above` without the node
  float gain = tree_.measure_of(parent);
  for (std::uint32_t above = parent, beside = tree_.sibling(node);;) {
    std::size_t count = 0;
    stack[count++] = {gain, beside};
    while (count != 0) {
      const Subtree subtree = stack[--count];
      // Any place further down costs at least the area of the node itself.
      if (!(subtree.gain - area > best.gain)) continue;
      if (++visits > max_visits) return best;
      const BinaryNode& root = tree_.node(subtree.root);
      const float place_gain = subtree.gain - tree_.measure(merge(root.bounds, box));
      if (place_gain > best.gain && subtree.root != tree_.sibling(node))
        best = {place_gain, node, subtree.root};
      const float gain_below = place_gain + tree_.measure_of(subtree.root);
      if (!root.is_leaf() && gain_below - area > best.gain) {
        stack[count++] = {gain_below, root.right()};
        stack[count++] = {gain_below, root.left()};
      }
    }
    rest = merge(rest, tree_.box(beside));
    if (above != parent) gain += tree_.measure_of(above) - tree_.measure(rest);
    if (above == 0) return best;
    beside = tree_.sibling(above);
    above = tree_.parent(above);
  }
}

// Makes the move if it pays, and returns by how much the cost changes. Others have been made since it was
// found.
double Reinsertion::make(const Move& move) {
  if (!tree_.can_move(move.node, move.target)) return 0.0;
  const double before = cost_above(tree_.parent(move.node), tree_.parent(move.target));
  const std::uint32_t place = tree_.move(move.node, move.target);
  const double after = cost_above(tree_.parent(place), move.target);
  if (after < before) return after - before;
  tree_.move(tree_.node(move.target).right(), place);
  return 0.0;
}

// Whether the node becomes a part of an inner node of the layout, and not of a leaf. Leaves of the tree have
// no more references than those of the layout.
bool Reinsertion::is_inner(std::uint32_t node) const {
  return tree_.references(node) > max_leaf_triangles;
}

// Of an inner node and of the leaves of the layout that are its children.
double Reinsertion::cost_at(std::uint32_t node) const {
  if (!is_inner(node)) return 0.0;
  double cost = tree_.measure_of(node);
  for (const std::uint32_t child : {tree_.node(node).left(), tree_.node(node).right()}) {
    if (!is_inner(child)) cost += costs_.leaf * tree_.measure_of(child);
  }
  return cost;
}

// Of the nodes from `a` and from `b` up to the root: a move changes no others.
double Reinsertion::cost_above(std::uint32_t a, std::uint32_t b) {
  path_.clear();
  for (;; a = tree_.parent(a)) {
    path_.push_back(a);
    if (a == 0) break;
  }
  double cost = 0.0;
  for (const std::uint32_t node : path_) cost += cost_at(node);
  for (; std::find(path_.begin(), path_.end(), b) == path_.end(); b = tree_.parent(b)) cost += cost_at(b);
  return cost;
}

double Reinsertion::cost() const {
  double cost = 0.0;
  for (std::uint32_t node = 0; node < tree_.node_count(); ++node) cost += cost_at(node);
  return cost;
}

}  // namespace kerf
