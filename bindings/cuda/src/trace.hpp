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
template <class Hierarchy, class Traversal>
KERF_CUDA_INLINE bool trace(const Hierarchy& hierarchy, const Ray& ray, Traversal& traversal) {
  TracedRay traced;
  if (!prepare(ray, hierarchy.bounds, traced)) return false;
  typename Traversal::Stack stack;
  traversal.start(hierarchy, traced, stack);
  while (traversal.step(hierarchy, traced)) {
  }
  return true;
}

/// The nearest hit of one of the few rays for which single precision leaves it open between `nearest` and
/// `rival`, or more. Out of line, as all that needs double precision is: it would leave no registers to the
/// traversal.
template <class ExactTraversal, class Hierarchy>
KERF_CUDA_NOINLINE NearestHit decide(Hierarchy hierarchy, const Ray* ray, std::uint32_t rival,
                                     NearestHit nearest) {
  if (rival != invalid_id) return nearer_of(ray, hierarchy.triangles, rival, nearest);
  ExactTraversal traversal;
  trace(hierarchy, *ray, traversal);
  return traversal.search.nearest;
}

template <template <bool, bool, bool> class Traversal = BinaryTraversal, class Hierarchy>
KERF_CUDA_INLINE Hit trace_closest(const Hierarchy& hierarchy, const MeshTable& meshes, const Ray& ray) {
  Traversal<false, false, false> traversal;
  if (!trace(hierarchy, ray, traversal)) return Hit{};
  auto& search = traversal.search;
  if (search.open()) {
    search.nearest = decide<Traversal<false, true, false>>(hierarchy, &ray, search.rival(), search.nearest);
  }
  return named(ray, hierarchy.triangles, search.nearest, meshes);
}

template <template <bool, bool, bool> class Traversal = BinaryTraversal, class Hierarchy>
KERF_CUDA_INLINE bool trace_any(const Hierarchy& hierarchy, const Ray& ray) {
  Traversal<true, false, false> traversal;
  if (!trace(hierarchy, ray, traversal)) return false;
  auto& search = traversal.search;
  if (search.open())
    search.nearest = decide<Traversal<true, true, false>>(hierarchy, &ray, search.rival(), search.nearest);
  return search.nearest.found();
}

}  // namespace kerf::cuda
