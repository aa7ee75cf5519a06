// The same tree around corners that have moved.
#pragma once

#include "build/finish.hpp"
#include "build/input.hpp"

namespace kerf::cuda {

/// Reference i with its triangle's corners as they are now. One that has no area any more is not found by
/// queries: its corners fall into one, and it has no number.
struct MoveReference {
  static constexpr std::uint32_t max_meshes = 64;  // as kernels take by value; more go in several runs

  InputMesh meshes[max_meshes];
  std::uint32_t mesh_count;
  std::uint32_t end;  // the number behind the last triangle of these meshes
  const std::uint32_t* numbers;
  DeviceTriangle* triangles;
  std::uint32_t* problems;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    const std::uint32_t number = numbers[i];
    if (number < meshes[0].first_triangle || number >= end) return;
    std::uint32_t m = 0;
    while (m + 1 < mesh_count && meshes[m + 1].first_triangle <= number) ++m;
    Corners corners = triangle_of(meshes[m], number - meshes[m].first_triangle, problems);
    const bool degenerate = is_degenerate(corners);
    if (degenerate) corners.b = corners.c = corners.a;
    triangles[i] = device_triangle(corners, degenerate ? invalid_id : number);
  }
};

/// The box of a leaf: around its triangles, whole ones also where it had a part.
KERF_CUDA_INLINE Box box_of_leaf(const DeviceTriangle* triangles, std::uint32_t link) {
  Box box = empty_box();
  const std::uint32_t first = leaf_first(link), count = leaf_count(link);
  for (std::uint32_t i = first; i < first + count; ++i)
    if (triangles[i].corner[0].w != invalid_id) box = merge(box, box_of(corners_in(triangles[i])));
  return box;
}

KERF_CUDA_INLINE void set_child_box(PairNode& node, int child, const Box& box) {
  float* xy = child == 0 ? node.first_xy : node.second_xy;
  xy[0] = box.lower[0];
  xy[1] = box.upper[0];
  xy[2] = box.lower[1];
  xy[3] = box.upper[1];
  node.z[2 * child] = box.lower[2];
  node.z[2 * child + 1] = box.upper[2];
}
/// Written by other threads meanwhile: read past the caches that do not know.
KERF_CUDA_INLINE Box child_box(const PairNode& pair, int child) {
  const volatile PairNode& node = pair;
  const volatile float* xy = child == 0 ? node.first_xy : node.second_xy;
  return {{xy[0], xy[2], node.z[2 * child]}, {xy[1], xy[3], node.z[2 * child + 1]}};
}

// Everything written before is seen by whoever arrives later. Returns how many had arrived before.
KERF_CUDA_INLINE std::uint32_t arrive(std::uint32_t* arrived) {
#ifdef __CUDA_ARCH__
  __threadfence();
  const std::uint32_t before = atomicAdd(arrived, 1u);
  __threadfence();
  return before;
#else
  return (*arrived)++;
#endif
}

/// Node i's leaves; then up the tree, at each node the one that arrives last (Karras 2012, "Maximizing
/// Parallelism in the Construction of BVHs, Octrees, and k-d Trees", section 4).
struct RefitNode {
  PairNode* nodes;
  const DeviceTriangle* triangles;
  SceneBounds* bounds;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    for (int child = 0; child < 2; ++child) {
      const std::uint32_t link = nodes[i].link[child];
      if ((link & leaf_bit) != 0) set_child_box(nodes[i], child, box_of_leaf(triangles, link));
    }
    while (true) {
      PairNode& node = nodes[i];
      const std::uint32_t inner =
          ((node.link[0] & leaf_bit) == 0 ? 1u : 0u) + ((node.link[1] & leaf_bit) == 0 ? 1u : 0u);
      if (arrive(&node.arrived) != inner) return;
      node.arrived = 0;
      const Box box = merge(child_box(node, 0), child_box(node, 1));
      if (node.parent == no_link) {
        for (int axis = 0; axis < 3; ++axis) {
          bounds->lower[axis] = box.lower[axis];
          bounds->upper[axis] = box.upper[axis];
        }
        return;
      }
      PairNode& parent = nodes[node.parent];
      set_child_box(parent, parent.link[0] == i ? 0 : 1, box);
      i = node.parent;
    }
  }
};

}  // namespace kerf::cuda
