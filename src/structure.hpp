// What a `Bvh` holds: the tree that is traced, and a copy of its triangles.
#pragma once

#include <vector>

#include <kerf/bvh.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

struct Bvh::Structure {
  BinaryTree tree;
  std::vector<Triangle> triangles;             // triangles[i] is that of tree.references[i]
  std::vector<std::uint32_t> first_triangles;  // of each mesh, see Geometry
  BvhStatistics statistics;
};

}  // namespace kerf
