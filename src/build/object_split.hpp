// Object splits: every reference goes whole to one child (Wald 2007, "On fast Construction of SAH-based
// Bounding Volume Hierarchies", for binning).
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "tree/reference.hpp"

namespace kerf {

/// Bins on each axis, for centroids and for chopped references alike. Fewer cost quality: see
/// docs/decisions.md.
inline constexpr int bin_count = 32;

/// Up to this many references every split between neighbouring centroids is tried, which is then also quicker
/// than filling bins.
inline constexpr std::uint32_t sweep_limit = 24;

/// A way to part the references of a node, with what it would cost.
struct ObjectSplit {
  /// Half area times references, summed over both children; infinite if the centroids cannot be parted.
  float cost = std::numeric_limits<float>::infinity();
  int axis = 0;
  float origin = 0.0f;  ///< of the bins, in doubled centroids
  float scale = 0.0f;   ///< from doubled centroids to bins
  std::uint32_t first_right =
      0;  ///< the first bin of the right child, or if swept: its first place in the order
  bool swept = false;
  Box3f left, right;

  bool found() const { return cost < std::numeric_limits<float>::infinity(); }
};

/// The cheapest object split of `references`, whose doubled centroids `centroids` bounds.
ObjectSplit find_object_split(std::span<const Reference> references, const Box3f& centroids);

/// Reorders `references` as `split` says; returns the number on the left, which is neither none nor all.
std::uint32_t partition(std::span<Reference> references, const ObjectSplit& split);

}  // namespace kerf
