// The wide tree that `kerf compare --device cuda` traces, by the kernels' code on the host.
#include <gtest/gtest.h>

#include "../compare/wide_traversal.hpp"
#include "support.hpp"

namespace kerf::cuda {
namespace {

struct HostWide {
  EncodedWide encoded;

  explicit HostWide(const SourceTree& tree) : encoded(encode_wide(tree)) {}
  WideHierarchy view() const {
    return {encoded.nodes.data(), encoded.triangles.data(), &encoded.bounds,
            static_cast<std::uint32_t>(encoded.nodes.size())};
  }
};

void expect_equal_hits(std::span<const TriangleMesh> meshes, std::span<const Ray> rays) {
  const Tree tree = build_tree(meshes);
  const kerf::Bvh bvh = make_bvh(tree);
  const std::vector<std::uint32_t> firsts = first_triangles_of(tree);
  const MeshTable table{firsts.data(), static_cast<std::uint32_t>(firsts.size() - 1)};
  const HostWide wide(source_of(tree));
  std::size_t differing_hits = 0, differing_answers = 0;
  for (const Ray& ray : rays) {
    const Hit closest = bvh.intersect(ray).value_or(Hit{});
    differing_hits += !(trace_closest<WideTraversal>(wide.view(), table, &ray) == closest);
    differing_answers += trace_any<WideTraversal>(wide.view(), &ray) != static_cast<bool>(closest);
  }
  EXPECT_EQ(differing_hits, 0u);
  EXPECT_EQ(differing_answers, 0u);
}

TEST(CudaWide, HitsOfOddRaysAreTheLibrarys) {
  for (const float scale : {1.0f, 1e-9f, 0x1p-110f, 3e12f, 0x1p80f}) {
    SCOPED_TRACE(scale);
    GridMeshes grid(scale);
    std::vector<Ray> rays(3000);
    for (Ray& ray : rays) ray = grid.ray();
    expect_equal_hits(grid.meshes, rays);
  }
}

TEST(CudaWide, SmallTreesAreTracedAsTheLibraryDoes) {
  GridMeshes grid(1.0f);
  std::vector<Ray> rays(300);
  for (Ray& ray : rays) ray = grid.ray();
  for (const std::size_t count : {0u, 1u, 2u, 5u, 9u, 30u}) {
    SCOPED_TRACE(count);
    const TriangleMesh mesh{.vertices = grid.vertices, .triangles = std::span(grid.triangles).first(count)};
    expect_equal_hits({&mesh, 1}, rays);
  }
}

TEST(CudaWide, BoxesOfLeavesMeetTheirTriangles) {
  GridMeshes grid(1.0f);
  const EncodedWide wide = encode_wide(source_of(build_tree(grid.meshes)));
  std::size_t leaves = 0;
  for (const CompressedNode& node : wide.nodes) {
    for (std::size_t slot = 0; slot < 8; ++slot) {
      if (node.kind[slot] < wide_leaf_bit) continue;
      ++leaves;
      // A triangle that was split reaches beyond its leaf.
      for (std::uint32_t i = 0; i < wide_leaf_count(node.kind[slot]); ++i) {
        const DeviceTriangle& triangle =
            wide.triangles[node.first_triangle + wide_leaf_offset(node.kind[slot]) + i];
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const float step = std::ldexp(1.0f, node.exponent[axis] - 127);
          const float lower = node.origin[axis] + step * node.plane[2 * axis][slot],
                      upper = node.origin[axis] + step * node.plane[2 * axis + 1][slot];
          float least = lower, most = upper;
          for (int c = 0; c < 3; ++c) {
            const Words4& words = triangle.corner[c];
            const float at = as_float(axis == 0 ? words.x : axis == 1 ? words.y : words.z);
            least = c == 0 ? at : std::min(least, at);
            most = c == 0 ? at : std::max(most, at);
          }
          EXPECT_LE(least, upper);
          EXPECT_GE(most, lower);
        }
      }
    }
  }
  EXPECT_GT(leaves, 0u);
}

}  // namespace
}  // namespace kerf::cuda
