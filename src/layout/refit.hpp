// New boxes for the same nodes, around triangles that have moved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "layout/pieces.hpp"
#include "layout/wide_bvh.hpp"
#include "simd/dispatch.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// What refits of a hierarchy need to know of it, however its triangles have moved since.
struct RefitBasis {
  Pieces pieces;
  std::vector<std::uint32_t> left_out;  ///< triangles that stand in no leaf
  double cost = 0.0;                    ///< see `traversal_cost`, of the hierarchy as it was
};

/// Whether no two leaves share memory: in a hierarchy that was built always, in one from a file perhaps not.
/// Throws `std::bad_alloc`.
bool leaves_are_apart(const WideBvh& wide);

/// Of a hierarchy whose leaves are apart and whose boxes hold all of its triangles. On all threads of the
/// task arena that this is called in. Throws `std::bad_alloc`.
RefitBasis make_refit_basis(const WideBvh& wide, std::size_t triangles);

/// A triangle without area is in no leaf of a build, because queries do not know such triangles. In a refit
/// its place in a leaf is taken by another triangle, which then stands in one leaf more.
struct StandIn {
  ChildLink leaf;
  std::uint32_t place;  ///< in the leaf
  std::uint32_t id;     ///< of the triangle whose place it is
};

/// Moves the triangles of `wide` to where those of `geometry` are, as many as before, and the boxes with
/// them. Triangles with a coordinate that is too large are treated as those without area. The arrays of
/// `wide` must be writable and nobody else's. `stand_ins` are those of the last refit, and become those of
/// this one. False if no triangle has an area: `wide` is worth nothing then. On all threads of the task arena
/// that this is called in. Throws `std::bad_alloc`, after which `wide` is worth nothing either unless
/// `stand_ins` are as they were.
bool refit(const RefitBasis& basis, const Geometry& geometry, Target target, WideBvh& wide,
           std::vector<StandIn>& stand_ins);

/// The cost of a random ray through the root by the surface area heuristic, in visits of a wide node.
double traversal_cost(const WideBvh& wide);

}  // namespace kerf
