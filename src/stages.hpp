// The road from meshes to a `Bvh` in its stages, for tools that look at what passes between them.
#pragma once

#include <kerf/build.hpp>
#include <kerf/counters.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// The last stage: from a tree to the structure that is traced, on so many threads, 0 for all. `build` is
/// this after `build_tree`.
Bvh make_bvh(const Geometry& geometry, BinaryTree tree, unsigned threads = 0);

/// The same traversals as `Bvh::intersect` and `Bvh::occluded`, counting as they go.
std::optional<Hit> intersect_counted(const Bvh& bvh, const Ray& ray, TraversalCounters& counters);
bool occluded_counted(const Bvh& bvh, const Ray& ray, TraversalCounters& counters);

}  // namespace kerf
