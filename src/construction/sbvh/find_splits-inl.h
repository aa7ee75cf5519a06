// The best object split of a node, and the best spatial split where one may be worth it.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_FIND_SPLITS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_FIND_SPLITS_INL_H
#undef KERF_CONSTRUCTION_SBVH_FIND_SPLITS_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_FIND_SPLITS_INL_H
#endif

#include <hwy/highway.h>

#include "base/parallel.hpp"
#include "construction/sbvh/object_split-inl.h"
#include "construction/sbvh/object_sweep-inl.h"
#include "construction/sbvh/spatial_bins-inl.h"
#include "construction/sbvh/spatial_split-inl.h"
#include "construction/sbvh/subtree.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

namespace {

// Whether a spatial split is possible at all.
bool may_split_space(const BuildContext& context, const Range& range) {
  return context.geometry != nullptr && range.slack() != 0 && range.count() >= context.min_spatial_count;
}

// Stich et al. 2009, section 4.5: where the children of the best object split hardly overlap, a spatial split
// can gain little.
bool overlap_calls_for_spatial_split(const BuildContext& context, const ChildBoxes& children, float area) {
  const SimdBox overlap = intersect(children.left, children.right);
  if (is_empty(overlap)) return false;
  const float overlap_area = half_area_of(overlap);
  return overlap_area > context.absolute_overlap && overlap_area >= context.relative_overlap * area;
}

// Nodes of at least twice as many references are binned by several threads, in blocks of about this size. The
// bins are the same for any number of blocks.
constexpr std::uint32_t binning_block = 8192;
constexpr std::uint32_t max_binning_blocks = 8;

HWY_NOINLINE void fill_in_blocks(Bins& object_bins, const BinMapping& object_mapping, int bin_count,
                                 SpatialBins& spatial_bins, const BinMapping& spatial_mapping,
                                 const Reference* references, std::uint32_t count) {
  struct BlockBins {
    Bins object;
    SpatialBins spatial;
  };
  BlockBins others[max_binning_blocks - 1];  // the first block goes straight to where all are added up
  const std::uint32_t blocks = HWY_MIN(count / binning_block, max_binning_blocks), size = count / blocks;
  parallel_for(blocks, [&](std::uint32_t i) {
    fill(i == 0 ? object_bins : others[i - 1].object, object_mapping, bin_count,
         i == 0 ? spatial_bins : others[i - 1].spatial, spatial_mapping, references + i * size,
         i + 1 == blocks ? count - i * size : size);
  });
  for (std::uint32_t i = 1; i < blocks; ++i) {
    add(object_bins, others[i - 1].object, bin_count);
    add(spatial_bins.begins, others[i - 1].spatial.begins, spatial_bin_count);
    add(spatial_bins.ends, others[i - 1].spatial.ends, spatial_bin_count);
  }
}

// The cheapest split of each kind.
struct Splits {
  ObjectSplit object;
  SpatialSplit spatial;
};

HWY_NOINLINE Splits find_splits(const BuildContext& context, const NodeInput& node) {
  const Reference* const references = context.arena + node.range.begin;
  const std::uint32_t count = node.range.count();
  const bool try_space = may_split_space(context, node.range);
  Splits splits{};
  ChildBoxes children{empty_box(), empty_box()};
  SpatialBins spatial_bins;
  const BinMapping spatial_mapping(node.box, spatial_bin_count);
  if (count <= sweep_limit) {
    splits.object = sweep(references, count);
    if (!try_space) return splits;
    for (std::uint32_t i = 0; i < count; ++i) {
      const BoxMask is_left =
          box_mask(doubled_centroid(references[i], splits.object.axis), splits.object.threshold);
      children.left = merge_if(is_left, children.left, load_box(references[i]));
      children.right = merge_if_not(is_left, children.right, load_box(references[i]));
    }
    fill(spatial_bins, references, count, spatial_mapping);
  } else {
    const int bin_count = count <= few_references ? few_object_bin_count : object_bin_count;
    const BinMapping mapping(node.doubled_centroids, bin_count);
    Bins bins;
    if (try_space && count >= 2 * binning_block) {
      fill_in_blocks(bins, mapping, bin_count, spatial_bins, spatial_mapping, references, count);
    } else if (try_space) {
      fill(bins, mapping, bin_count, spatial_bins, spatial_mapping, references, count);
    } else {
      fill(bins, references, count, mapping, bin_count);
    }
    splits.object = cheapest(bins, count, mapping, bin_count);
    if (!try_space) return splits;
    children = child_boxes(bins, splits.object, bin_count);
  }

  if (overlap_calls_for_spatial_split(context, children, half_area(node.box))) {
    splits.spatial = find_spatial_split(*context.geometry, spatial_bins, spatial_mapping, references,
                                        node.range, node.box, splits.object.cost);
  }
  return splits;
}

}  // namespace

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
