// What one task of a build does on one thread, compiled once for every instruction set.
#pragma once

#include <cstdint>

#include "construction/sbvh/arena.hpp"
#include "simd/dispatch.hpp"
#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// What all nodes of a build share.
struct BuildContext {
  const Geometry* geometry = nullptr;  ///< null: object splits only
  Reference* arena = nullptr;
  std::uint32_t max_leaf_size = 8;
  float absolute_overlap = 0.0f;        ///< alpha times the root's half area; a spatial split is tried only
                                        ///< where the children of the object split overlap by more
  float relative_overlap = 0.0f;        ///< and by at least this fraction of the node's own half area,
  std::uint32_t min_spatial_count = 2;  ///< in nodes of at least this many references
  Target target = choose_target();
};

/// A node to be split.
struct NodeInput {
  Range range;
  std::uint32_t depth = 0;
  Box3f box;
  Box3f doubled_centroids;  ///< bounds of lower plus upper corner of each reference
};

/// Splits a node in place, and says what its children are; false if it is to be a leaf.
bool split_node(const BuildContext& context, const NodeInput& node, NodeInput& left, NodeInput& right);

struct SubtreeSize {
  std::uint32_t nodes, references;
};

/// Builds the subtree with the root `node`, and numbers its nodes and references from 0. There must be room
/// for two nodes and one reference per place of the node's range.
SubtreeSize build_subtree(const BuildContext& context, const NodeInput& node, BinaryNode* nodes,
                          std::uint32_t* references);

// Single steps of a split, for tests and measurements:

/// The boxes of both children of a reference that is chopped, as `chop` in math/clip.hpp.
void chop_reference(const BuildContext& context, const Reference& reference, int axis, float plane,
                    Box3f& left, Box3f& right);

/// The costs of a node's cheapest splits: half area times references, summed over both children. Infinite
/// where there is no such split, or where the spatial one is no cheaper.
struct SplitCosts {
  float object, spatial;
};
SplitCosts bin_node(const BuildContext& context, const NodeInput& node);

/// Of the first `count` references of the arena, moves those whose doubled centroids lie below `position` to
/// the front. Returns their number.
std::uint32_t partition_references(const BuildContext& context, std::uint32_t count, int axis,
                                   float position);

}  // namespace kerf
