// From references along Morton's curve to a binary tree: neighbours are merged, nearest first (Meister &
// Bittner 2018, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction").
#pragma once

#include "presplit.hpp"

namespace kerf::cuda {

inline constexpr std::uint32_t no_node = 0xffffffffu;

/// Nodes 0 .. n - 1 are the n references in the order of the curve; behind them stand the inner ones in the
/// order in which they are made, each behind its children, the root last.
struct MergedNode {
  Box box;
  std::uint32_t child[2];  // of an inner node; of a reference the triangle's number, and nothing
  std::uint32_t parent;
  std::uint32_t references;  // below
  std::uint32_t inner;       // nodes at and below it that stay, if it is under none that becomes a leaf
  float cost;                // of the surface area heuristic
};

KERF_CUDA_INLINE bool becomes_leaf(const MergedNode& node) {
  return node.inner == 0;
}

/// For each cluster the one to merge with: that within `radius` places with which it makes the smallest box.
/// Of equally good ones the neighbour whose number differs in the last bit alone, then the lowest: all
/// clusters rank pairs alike, so that the best pair of all always agrees.
struct FindNeighbour {
  const MergedNode* nodes;
  const std::uint32_t* clusters;
  std::uint32_t count;
  std::uint32_t radius;
  float unit;
  std::uint32_t* neighbour;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    const Box box = nodes[clusters[i]].box;
    const std::uint32_t begin = i > radius ? i - radius : 0,
                        end = count - i > radius ? i + radius + 1 : count;
    const std::uint32_t buddy = (i ^ 1) < count ? i ^ 1 : (i == 0 ? 1 : i - 1);
    std::uint32_t best = buddy;
    float best_area = half_area(merge(box, nodes[clusters[buddy]].box), unit);
    for (std::uint32_t j = begin; j < end; ++j) {
      if (j == i) continue;
      const float area = half_area(merge(box, nodes[clusters[j]].box), unit);
      if (area < best_area || (area == best_area && best != (i ^ 1) && j < best)) {
        best = j;
        best_area = area;
      }
    }
    neighbour[i] = best;
  }
};

/// Which clusters stay (low half) and which merge with their neighbour behind them (high half).
struct MarkMerges {
  const std::uint32_t* neighbour;
  std::uint32_t count;
  std::uint64_t* marks;  // one more, so that the sums before it are those of all

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    if (i == 0) marks[count] = 0;
    const std::uint32_t j = neighbour[i];
    const bool agreed = neighbour[j] == i;
    const bool stays = !agreed || i < j;
    marks[i] = (stays ? 1u : 0u) | (static_cast<std::uint64_t>(agreed && i < j ? 1 : 0) << 32);
  }
};

struct MergeClusters {
  MergedNode* nodes;
  const std::uint32_t* clusters;
  const std::uint32_t* neighbour;
  const std::uint64_t* marks;
  const std::uint64_t* before;  // the sums of the marks before each
  std::uint32_t* next_clusters;
  std::uint32_t first_new;  // node
  std::uint32_t max_leaf_size;
  float unit;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    constexpr float inner_node_cost = 1.2f, triangle_cost = 1.0f;
    const std::uint64_t mark = marks[i];
    if ((mark & 1) == 0) return;
    std::uint32_t number = clusters[i];
    if ((mark >> 32) != 0) {
      const std::uint32_t left = number, right = clusters[neighbour[i]];
      number = first_new + static_cast<std::uint32_t>(before[i] >> 32);
      const MergedNode &a = nodes[left], &b = nodes[right];
      MergedNode node;
      node.box = merge(a.box, b.box);
      node.child[0] = left;
      node.child[1] = right;
      node.parent = no_node;
      node.references = a.references + b.references;
      const float area = half_area(node.box, unit);
      const float as_leaf = node.references <= max_leaf_size
                                ? area * triangle_cost * static_cast<float>(node.references)
                                : FLT_MAX;
      const float as_node = area * inner_node_cost + a.cost + b.cost;
      node.cost = minimum(as_leaf, as_node);
      node.inner = as_leaf <= as_node ? 0 : 1 + a.inner + b.inner;
      nodes[number] = node;
      nodes[left].parent = number;
      nodes[right].parent = number;
    }
    next_clusters[static_cast<std::uint32_t>(before[i])] = number;
  }
};

}  // namespace kerf::cuda
