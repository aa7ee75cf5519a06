// Meshes as the device reads them.
#pragma once

#include <cstddef>

#include "ploc.hpp"

namespace kerf::cuda {

/// A mesh in memory of the device, and the number of its first triangle.
struct InputMesh {
  const std::byte* vertices;
  std::size_t vertex_stride;  // bytes
  std::uint32_t vertex_count;
  const std::byte* triangles;
  std::size_t triangle_stride;
  std::uint32_t triangle_count;
  std::uint32_t first_triangle;
};

/// Bits that kernels set for what is wrong with a mesh.
inline constexpr std::uint32_t index_out_of_range = 1, vertex_not_finite = 2;

KERF_CUDA_INLINE void set_bits(std::uint32_t* word, std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  atomicOr(word, bits);
#else
  *word |= bits;
#endif
}

KERF_CUDA_INLINE Vec3f vertex_of(const InputMesh& mesh, std::uint32_t i, int corner,
                                 std::uint32_t* problems) {
  const auto* triangle = reinterpret_cast<const std::uint32_t*>(mesh.triangles + i * mesh.triangle_stride);
  std::uint32_t number = triangle[corner];
  if (number >= mesh.vertex_count) {
    set_bits(problems, index_out_of_range);
    number = 0;
  }
  const auto* at = reinterpret_cast<const float*>(mesh.vertices + number * mesh.vertex_stride);
  Vec3f v;
  v.x = at[0];
  v.y = at[1];
  v.z = at[2];
  // Below 2^126, as `TriangleMesh` asks for; what is no number is not below.
  if (!(absolute(v.x) < 0x1p126f && absolute(v.y) < 0x1p126f && absolute(v.z) < 0x1p126f)) {
    set_bits(problems, vertex_not_finite);
    v.x = v.y = v.z = 0.0f;
  }
  return v;
}
KERF_CUDA_INLINE Corners triangle_of(const InputMesh& mesh, std::uint32_t i, std::uint32_t* problems) {
  return {vertex_of(mesh, i, 0, problems), vertex_of(mesh, i, 1, problems), vertex_of(mesh, i, 2, problems)};
}
KERF_CUDA_INLINE DeviceTriangle device_triangle(const Corners& t, std::uint32_t number) {
  DeviceTriangle result;
  const Vec3f corner[3] = {t.a, t.b, t.c};
  for (int i = 0; i < 3; ++i)
    result.corner[i] = {as_bits(corner[i].x), as_bits(corner[i].y), as_bits(corner[i].z), number};
  return result;
}

/// Triangle i of the mesh, with its box; an empty one if it is degenerate.
struct ReadTriangle {
  InputMesh mesh;
  DeviceTriangle* triangles;
  Box* boxes;
  std::uint32_t* problems;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    const Corners corners = triangle_of(mesh, i, problems);
    const std::uint32_t number = mesh.first_triangle + i;
    triangles[number] = device_triangle(corners, number);
    boxes[number] = is_degenerate(corners) ? empty_box() : box_of(corners);
  }
};

struct FindPriority {
  const DeviceTriangle* triangles;
  const Box* boxes;
  Grid grid;
  std::uint32_t* priorities;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    priorities[i] = is_empty(boxes[i]) ? 0 : split_priority(corners_in(triangles[i]), boxes[i], grid);
  }
};
/// The number of references of triangle i.
struct CountReferences {
  const Box* boxes;
  const std::uint32_t* priorities;
  std::uint64_t factor;

  KERF_CUDA_INLINE std::uint64_t operator()(std::uint32_t i) const {
    return is_empty(boxes[i]) ? 0 : 1 + splits_of(priorities[i], factor);
  }
};
struct WriteCounts {
  CountReferences count;
  std::uint64_t* counts;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const { counts[i] = count(i); }
};
struct SplitTriangles {
  const DeviceTriangle* triangles;
  CountReferences count;
  const std::uint64_t* first;
  Grid grid;
  Reference* references;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    const auto room = static_cast<std::uint32_t>(count(i));
    if (room == 0) return;
    Reference* out = references + first[i];
    const std::uint32_t made =
        split_triangle(corners_in(triangles[i]), count.boxes[i], i, room - 1, grid, out);
    for (std::uint32_t k = made; k < room; ++k) out[k] = {empty_box(), invalid_id};
  }
};
/// Places that were left empty come last.
struct FindKeys {
  const Reference* references;
  Grid grid;
  std::uint64_t* keys;
  std::uint32_t* order;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    keys[i] = references[i].triangle == invalid_id ? ~std::uint64_t{0} : morton(references[i].box, grid);
    order[i] = i;
  }
};
struct IsThere {
  const Reference* references;
  KERF_CUDA_INLINE std::uint64_t operator()(std::uint32_t i) const {
    return references[i].triangle != invalid_id;
  }
};
/// Reference i along the curve as a node.
struct StartNode {
  const Reference* references;
  const std::uint32_t* order;
  float unit;
  MergedNode* nodes;
  std::uint32_t* clusters;

  KERF_CUDA_BOTH void operator()(std::uint32_t i) const {
    const Reference& reference = references[order[i]];
    MergedNode node;
    node.box = reference.box;
    node.child[0] = reference.triangle;
    node.child[1] = no_node;
    node.parent = no_node;
    node.references = 1;
    node.inner = 0;
    node.cost = half_area(reference.box, unit);
    nodes[i] = node;
    clusters[i] = i;
  }
};

}  // namespace kerf::cuda
