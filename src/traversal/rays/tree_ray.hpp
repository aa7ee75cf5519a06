// Rays through a binary tree as it is, one node at a time.
#pragma once

#include <kerf/counters.hpp>
#include <kerf/ray.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// The closest hit, or if `any_hit` the first one found; no hit, if there is none. Its primitive is the
/// number of the triangle in `geometry`, its mesh is 0. Adds to `counters`: a step is the visit of an inner
/// node, which tests the boxes of both children.
Hit trace_tree(const BinaryTree& tree, const Geometry& geometry, const Ray& ray, bool any_hit,
               TraversalCounters& counters);

}  // namespace kerf
