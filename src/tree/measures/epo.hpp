// End-point overlap: the cost of the nodes that hold a point of the surface though no triangle below them
// does. <kerf/inspect.hpp> has the formula.
#pragma once

#include <kerf/inspect.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// Visits of nodes per triangle and per doubling of the number of triangles. Scenes of surfaces stay below 8,
/// long triangles in all directions in one ball below 16.
inline constexpr double default_visits_per_level = 24.0;

/// As Aila, Karras & Laine 2013, section 4, define it, for trees whose leaves hold parts of triangles as
/// well. A triangle belongs to a subtree if any leaf of the subtree references it. A part of a triangle that
/// lies in the box of a node but is referenced by a leaf elsewhere is thus no overlap: a ray that ends there
/// may find the triangle in either place. The measure is the same function of boxes and references for every
/// builder, and for trees without spatial splits exactly the paper's. 0 for an empty tree. An estimate where
/// the visits of nodes would exceed `visits_per_level` times n log2 n.
Estimate end_point_overlap(const BinaryTree& tree, const Geometry& geometry,
                           double visits_per_level = default_visits_per_level);

}  // namespace kerf
