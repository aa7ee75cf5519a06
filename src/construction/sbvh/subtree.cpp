#include "construction/sbvh/subtree.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#define KERF_FOUR_LANES
#include "simd/targets.hpp"
#include "tree/measures/sah.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "construction/sbvh/subtree.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "construction/sbvh/find_splits-inl.h"
#include "construction/sbvh/object_partition-inl.h"
#include "construction/sbvh/object_sweep-inl.h"
#include "construction/sbvh/reference-inl.h"
#include "construction/sbvh/spatial_partition-inl.h"
#include "simd/box-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

static_assert(triangle_cost == 1.0, "costs of splits count triangles");

// Whether a leaf costs no more than an inner node whose children cost `children_cost`.
bool leaf_is_cheapest(const BuildContext& context, std::uint32_t count, float area, float children_cost) {
  return count <= context.max_leaf_size &&
         area * static_cast<float>(count) <= static_cast<float>(inner_node_cost) * area + children_cost;
}

// Near the maximum depth, nodes are halved whatever the cost: see max_tree_depth.
bool must_halve(std::uint32_t count, std::uint32_t depth) {
  return depth + static_cast<std::uint32_t>(std::bit_width(count)) >= max_tree_depth;
}

// Computes the boxes of a child where the split itself does not.
void measure(const Reference* arena, NodeInput& node) {
  SimdBox box = empty_box(), centroids = box;
  for (std::uint32_t i = node.range.begin; i < node.range.end; ++i) {
    const SimdBox reference = load_box(arena[i]);
    box = merge(box, reference);
    centroids = merge(centroids, centroid_box(reference));
  }
  node.box = to_box3f(box);
  node.doubled_centroids = to_box3f(centroids);
}

void halve(const BuildContext& context, const NodeInput& node, NodeInput& left, NodeInput& right) {
  const std::uint32_t left_count = node.range.count() / 2;
  const RangePair ranges = hand_down(context.arena, node.range, left_count, node.range.count() - left_count);
  left = {ranges.left, node.depth + 1, {}, {}};
  right = {ranges.right, node.depth + 1, {}, {}};
  measure(context.arena, left);
  measure(context.arena, right);
}

HWY_NOINLINE bool split(const BuildContext& context, const NodeInput& node, NodeInput& left,
                        NodeInput& right) {
  Reference* const references = context.arena + node.range.begin;
  const std::uint32_t count = node.range.count();
  const float area = half_area(node.box);
  if (node.doubled_centroids.lower == node.doubled_centroids.upper || must_halve(count, node.depth)) {
    if (count <= context.max_leaf_size) return false;
    halve(context, node, left, right);
    return true;
  }

  const Splits splits = find_splits(context, node);
  const ObjectSplit& object_split = splits.object;
  const SpatialSplit& spatial_split = splits.spatial;
  if (leaf_is_cheapest(context, count, area, HWY_MIN(object_split.cost, spatial_split.cost))) return false;

  if (spatial_split.cost < object_split.cost) {
    const SpatialPartition parts = partition(*context.geometry, references, count, spatial_split);
    if (parts.left_count != 0 && parts.right_count != 0) {
      const RangePair ranges = hand_down(context.arena, node.range, parts.left_count, parts.right_count);
      left = {ranges.left, node.depth + 1, to_box3f(parts.boxes.left), to_box3f(parts.centroids.left)};
      right = {ranges.right, node.depth + 1, to_box3f(parts.boxes.right), to_box3f(parts.centroids.right)};
      return true;
    }
  }
  if (!object_split.found()) {
    if (count <= context.max_leaf_size) return false;
    halve(context, node, left, right);
    return true;
  }
  const Partition parts = partition(references, count, object_split);
  const RangePair ranges = hand_down(context.arena, node.range, parts.left_count, count - parts.left_count);
  left = {ranges.left, node.depth + 1, to_box3f(parts.boxes.left), to_box3f(parts.centroids.left)};
  right = {ranges.right, node.depth + 1, to_box3f(parts.boxes.right), to_box3f(parts.centroids.right)};
  return true;
}

class SubtreeBuilder {
 public:
  SubtreeBuilder(const BuildContext& context, BinaryNode* nodes, std::uint32_t* references)
      : context_(context), nodes_(nodes), references_(references) {}

  SubtreeSize build(const NodeInput& node) {
    build_node(0, node);
    return {node_count_, reference_count_};
  }

 private:
  void build_node(std::uint32_t slot, const NodeInput& node) {
    Reference* const references = context_.arena + node.range.begin;
    if (node.range.count() < context_.min_spatial_count && node.range.count() <= sweep_limit) {
      return build_small(slot, references, node.range.count(), node.depth, to_simd_box(node.box));
    }
    nodes_[slot].bounds = node.box;
    NodeInput left, right;
    if (!split(context_, node, left, right)) return make_leaf(slot, references, node.range.count());
    const std::uint32_t child = make_inner(slot);
    build_node(child, left);
    build_node(child + 1, right);
  }

  // Tries every object split of few references, and no spatial ones. Most nodes of a tree are built here.
  void build_small(std::uint32_t slot, Reference* references, std::uint32_t count, std::uint32_t depth,
                   const SimdBox& box) {
    nodes_[slot].bounds = to_box3f(box);
    if (count == 1) return make_leaf(slot, references, count);
    ChildBoxes children{empty_box(), empty_box()};
    std::uint32_t left_count = count / 2;
    if (count == 2) {  // there is only one split
      children = {load_box(references[0]), load_box(references[1])};
      const float cost = half_area_of(children.left) + half_area_of(children.right);
      if (leaf_is_cheapest(context_, count, half_area_of(box), cost))
        return make_leaf(slot, references, count);
    } else {
      ObjectSplit split;
      if (!must_halve(count, depth)) split = sweep(references, count);
      if (leaf_is_cheapest(context_, count, half_area_of(box), split.cost))
        return make_leaf(slot, references, count);
      if (split.found()) {
        left_count = partition_few(references, count, split, children);
      } else {
        for (std::uint32_t i = 0; i < count; ++i) {
          SimdBox& side = i < left_count ? children.left : children.right;
          side = merge(side, load_box(references[i]));
        }
      }
    }
    const std::uint32_t child = make_inner(slot);
    build_small(child, references, left_count, depth + 1, children.left);
    build_small(child + 1, references + left_count, count - left_count, depth + 1, children.right);
  }

  std::uint32_t make_inner(std::uint32_t slot) {
    nodes_[slot].first = node_count_;
    nodes_[slot].count = 0;
    node_count_ += 2;
    return nodes_[slot].first;
  }

  void make_leaf(std::uint32_t slot, const Reference* references, std::uint32_t count) {
    nodes_[slot].first = reference_count_;
    nodes_[slot].count = count;
    for (std::uint32_t i = 0; i < count; ++i) references_[reference_count_++] = references[i].primitive;
  }

  const BuildContext& context_;
  BinaryNode* nodes_;
  std::uint32_t* references_;
  std::uint32_t node_count_ = 1, reference_count_ = 0;
};

bool split_node(const BuildContext& context, const NodeInput& node, NodeInput& left, NodeInput& right) {
  return split(context, node, left, right);
}

SubtreeSize build_subtree(const BuildContext& context, const NodeInput& node, BinaryNode* nodes,
                          std::uint32_t* references) {
  return SubtreeBuilder(context, nodes, references).build(node);
}

void chop_reference(const BuildContext& context, const Reference& reference, int axis, float plane,
                    Box3f& left, Box3f& right) {
  const ChildBoxes parts = chop(*context.geometry, reference, axis, plane);
  left = to_box3f(parts.left);
  right = to_box3f(parts.right);
}

SplitCosts bin_node(const BuildContext& context, const NodeInput& node) {
  const Splits splits = find_splits(context, node);
  return {splits.object.cost, splits.spatial.cost};
}

std::uint32_t partition_references(Reference* references, std::uint32_t count, int axis, float position) {
  ObjectSplit split{};
  split.axis = axis;
  split.scale = 1.0f;
  split.threshold = position;
  return partition(references, count, split).left_count;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(split_node);
HWY_EXPORT(build_subtree);
HWY_EXPORT(chop_reference);
HWY_EXPORT(bin_node);
HWY_EXPORT(partition_references);

bool split_node(const BuildContext& context, const NodeInput& node, NodeInput& left, NodeInput& right) {
  return KERF_DISPATCH(split_node, context.target)(context, node, left, right);
}

SubtreeSize build_subtree(const BuildContext& context, const NodeInput& node, BinaryNode* nodes,
                          std::uint32_t* references) {
  return KERF_DISPATCH(build_subtree, context.target)(context, node, nodes, references);
}

void chop_reference(const BuildContext& context, const Reference& reference, int axis, float plane,
                    Box3f& left, Box3f& right) {
  KERF_DISPATCH(chop_reference, context.target)(context, reference, axis, plane, left, right);
}

SplitCosts bin_node(const BuildContext& context, const NodeInput& node) {
  return KERF_DISPATCH(bin_node, context.target)(context, node);
}

std::uint32_t partition_references(const BuildContext& context, std::uint32_t count, int axis,
                                   float position) {
  return KERF_DISPATCH(partition_references, context.target)(context.arena, count, axis, position);
}

}  // namespace kerf
#endif
