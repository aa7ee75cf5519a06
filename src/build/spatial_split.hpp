// Spatial splits: a plane parts the node, and references that straddle it go to both children (Stich,
// Friedrich & Dietrich 2009, section 4).
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// A plane, with what parting the references there would cost if every straddling one went to both sides.
struct SpatialSplit {
  float cost = std::numeric_limits<float>::infinity();  ///< as that of an object split
  int axis = 0;
  float plane = 0.0f;
  float origin = 0.0f;  ///< of the bins that found the plane
  float scale = 0.0f;   ///< from coordinates to bins
  int first_right = 0;  ///< the first bin on the right of the plane
  std::uint32_t left_count = 0, right_count = 0;
  Box3f left, right;

  bool found() const { return cost < std::numeric_limits<float>::infinity(); }
};

/// The cheapest of the equidistant planes on all three axes of `box` that makes at most `slack` references
/// more.
SpatialSplit find_spatial_split(const Geometry& geometry, std::span<const Reference> references,
                                const Box3f& box, std::uint32_t slack);

/// Carries `split` out in place: those of `references` that belong to the left child come first, those of the
/// right follow, and the latter run on into `spare` where straddling references are divided. A straddling one
/// is kept whole on one side if that costs less (reference unsplitting, section 4.4 of the paper).
struct SpatialPartition {
  std::uint32_t left_count, right_count;
};
SpatialPartition partition(const Geometry& geometry, std::span<Reference> references, Reference* spare,
                           const SpatialSplit& split);

}  // namespace kerf
