// A ray from the caller's form to its hit.
#pragma once

#include <kerf/query.hpp>

#include "binary_traversal.hpp"

namespace kerf::cuda {

/// The number of each mesh's first triangle.
struct MeshTable {
  const std::uint32_t* first_triangles;
  std::uint32_t mesh_count;

  /// The triangle with number `id` by its mesh.
  KERF_CUDA_INLINE PrimitiveId locate(std::uint32_t id) const {
    std::uint32_t mesh = 0, first = 0;
    if (mesh_count > 1) {
      std::uint32_t end = mesh_count;  // first_triangles[mesh] <= id < first_triangles[end]
      while (end - mesh > 1) {
        const std::uint32_t middle = mesh + (end - mesh) / 2;
        if (first_triangles[middle] <= id)
          mesh = middle;
        else
          end = middle;
      }
      first = first_triangles[mesh];
    }
    return {id - first, mesh};
  }
};

/// The hit as the caller sees it; one that converts to false for a miss.
KERF_CUDA_INLINE Hit named(const Ray& ray, const DeviceTriangle* triangles, const NearestHit& nearest,
                           const MeshTable& meshes) {
  Hit result;
  if (!nearest.found()) return result;
  const DeviceTriangle* triangle = triangles + nearest.reference;
  const RayCrossing crossing = settled_hit(&ray, triangle);
  const PrimitiveId place = meshes.locate(number_of(*triangle));
  result.t = unscaled(ray, crossing.t);
  result.u = crossing.u;
  result.v = crossing.v;
  result.primitive = place.primitive;
  result.mesh = place.mesh;
  return result;
}

/// Traces one ray from beginning to end. False, and nothing traced, for a ray that can hit nothing.
template <class Traversal>
KERF_CUDA_INLINE bool trace(const BinaryHierarchy& hierarchy, const Ray& ray, Traversal& traversal) {
  TracedRay traced;
  if (!prepare(ray, hierarchy.bounds, traced)) return false;
  traversal.start(hierarchy, traced);
  typename Traversal::Stack stack;
  while (traversal.step(hierarchy, traced, stack)) {
  }
  return true;
}

/// The nearest hit of one of the few rays for which single precision leaves it open between `nearest` and
/// `rival`, or more. Out of line, as all that needs double precision is: it would leave no registers to the
/// traversal.
template <bool any_hit>
KERF_CUDA_NOINLINE NearestHit decide(BinaryHierarchy hierarchy, const Ray* ray, std::uint32_t rival,
                                     NearestHit nearest) {
  if (rival != invalid_id) return nearer_of(ray, hierarchy.triangles, rival, nearest);
  BinaryTraversal<any_hit, true> traversal;
  trace(hierarchy, *ray, traversal);
  return traversal.nearest;
}

KERF_CUDA_INLINE Hit trace_closest(const BinaryHierarchy& hierarchy, const MeshTable& meshes,
                                   const Ray& ray) {
  BinaryTraversal<false> traversal;
  if (!trace(hierarchy, ray, traversal)) return Hit{};
  if (traversal.open())
    traversal.nearest = decide<false>(hierarchy, &ray, traversal.rival(), traversal.nearest);
  return named(ray, hierarchy.triangles, traversal.nearest, meshes);
}

KERF_CUDA_INLINE bool trace_any(const BinaryHierarchy& hierarchy, const Ray& ray) {
  BinaryTraversal<true> traversal;
  if (!trace(hierarchy, ray, traversal)) return false;
  if (traversal.open())
    traversal.nearest = decide<true>(hierarchy, &ray, traversal.rival(), traversal.nearest);
  return traversal.nearest.found();
}

}  // namespace kerf::cuda
