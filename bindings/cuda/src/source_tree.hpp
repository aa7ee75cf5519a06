// What device layouts are made from: a binary tree and the triangles of its references.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <kerf/layout.hpp>
#include <kerf/tree.hpp>
#include <kerf/vec.hpp>

namespace kerf::cuda {

struct SourceNode {
  Box3f box;
  std::uint32_t first = 0;  ///< inner: its left child, the right one follows; leaf: its first reference
  std::uint32_t count = 0;  ///< inner: 0; leaf: its number of references
};

struct SourceTriangle {
  std::array<Vec3f, 3> corner;
  std::uint32_t number = 0;  ///< counted over all meshes
};

/// Children stand after their parent. `nodes[0]` is the root; a tree of nothing has no nodes.
struct SourceTree {
  std::vector<SourceNode> nodes;
  std::vector<SourceTriangle> references;
  Box3f bounds;
};

/// Of a hierarchy as it is traced: between a wide node and its children, of which there are up to sixteen,
/// binary nodes stand where the surface area heuristic finds them cheapest.
SourceTree source_of(const Layout& layout);

/// Of a builder's tree, as it is.
SourceTree source_of(const Tree& tree);

/// The number of each mesh's first triangle, and of all triangles at the end. Meshes without triangles at the
/// end are left out.
std::vector<std::uint32_t> first_triangles_of(const Tree& tree);

/// The same tree with leaves of at most `max_leaf_size` references: larger ones are split where the surface
/// area heuristic finds it cheapest.
SourceTree with_small_leaves(SourceTree tree, std::uint32_t max_leaf_size);

}  // namespace kerf::cuda
