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

/// Traces one ray from beginning to end.
template <class Hierarchy, class Traversal>
KERF_CUDA_INLINE void trace(const Hierarchy& hierarchy, const Ray* ray, TracedRay& traced,
                            Traversal& traversal) {
  traversal.search.skip(false);
  traced.t_min = traced.min_value = 0.0f;
  if (!prepare(ray, hierarchy.bounds, traced)) return;
  traversal.search.skip(true);
  if (traced.is_wider) return;
  traversal.search.begin(traced);
  typename Traversal::Stack stack;
  traversal.run(hierarchy, traced, stack);
}

/// The nearest hit at or behind `t_min`, all in exact terms. Out of line, as all that needs double precision
/// is: it would leave no registers to the traversal.
template <class ExactTraversal, class Hierarchy>
KERF_CUDA_NOINLINE NearestHit trace_exactly(Hierarchy hierarchy, const Ray* ray, float t_min) {
  TracedRay traced;
  ExactTraversal traversal;
  traversal.search.skip(false);
  if (!prepare(ray, hierarchy.bounds, traced)) return traversal.search.nearest;
  traced.t_min = maximum(traced.t_min, t_min);
  if (!(traced.t_min <= traced.t_max)) return traversal.search.nearest;
  traversal.search.begin(traced);
  typename ExactTraversal::Stack stack;
  traversal.run(hierarchy, traced, stack);
  return traversal.search.nearest;
}

/// `nearest` is a hit of the ray as it is traced. If its range holds more than the caller's does, the hit is
/// the first in that, or none. `crossing` becomes the caller's.
template <template <bool, bool, bool> class Traversal, class Hierarchy>
KERF_CUDA_NOINLINE NearestHit unscaled_hit(Hierarchy hierarchy, const Ray* ray, NearestHit nearest,
                                           RayCrossing* crossing) {
  const bool far = is_far(*ray, *hierarchy.bounds);
  const double scale = scale_of(ray->direction, far);
  const bool is_wider = has_subnormal_limit(*ray, far);
  while (nearest.found()) {
    *crossing = settled_hit(ray, hierarchy.bounds, hierarchy.triangles + nearest.reference);
    const float t = crossing->t;
    if (scale != 1.0) crossing->t = round_distance(t / scale);
    if (is_wider && crossing->t > ray->t_max) nearest.reference = invalid_id;
    if (!is_wider || crossing->t >= ray->t_min) break;
    nearest = trace_exactly<Traversal<false, true, false>>(hierarchy, ray, next_after(t));
  }
  return nearest;
}

/// The nearest hit of one of the few rays for which single precision leaves it open between `nearest` and
/// `rival`, or more.
template <template <bool, bool, bool> class Traversal, bool any_hit, class Hierarchy>
KERF_CUDA_NOINLINE NearestHit decide(Hierarchy hierarchy, const Ray* ray, float t_min, std::uint32_t rival,
                                     NearestHit nearest) {
  if (rival != invalid_id)
    return nearer_of(ray, hierarchy.bounds, t_min, hierarchy.triangles, rival, nearest);
  if (any_hit && has_subnormal_limit(*ray, is_far(*ray, *hierarchy.bounds))) {
    RayCrossing crossing;
    nearest = trace_exactly<Traversal<false, true, false>>(hierarchy, ray, -FLT_MAX);
    return unscaled_hit<Traversal>(hierarchy, ray, nearest, &crossing);
  }
  return trace_exactly<Traversal<any_hit, true, false>>(hierarchy, ray, -FLT_MAX);
}

/// The hit as the caller sees it; one that converts to false for a miss.
template <template <bool, bool, bool> class Traversal, class Hierarchy>
KERF_CUDA_INLINE Hit named(const Hierarchy& hierarchy, const MeshTable& meshes, const Ray* source,
                           bool may_be_far, NearestHit nearest) {
  Hit result;
  if (!nearest.found()) return result;
  const Ray ray = read(source);
  RayCrossing crossing;
  if (needs_scaling(ray.direction, may_be_far)) {
    nearest = unscaled_hit<Traversal>(hierarchy, source, nearest, &crossing);
    if (!nearest.found()) return result;
  } else {
    const DeviceTriangle* triangle = hierarchy.triangles + nearest.reference;
    const CrossingEstimate estimate = estimate_crossing(ray.origin, ray.direction, corners_of(*triangle));
    crossing = estimate.steep() && estimate.precise() ? estimate.crossing(estimate.height)
                                                      : exact_hit(source, hierarchy.bounds, triangle);
  }
  const PrimitiveId place = meshes.locate(number_of(hierarchy.triangles[nearest.reference]));
  result.t = crossing.t;
  result.u = crossing.u;
  result.v = crossing.v;
  result.primitive = place.primitive;
  result.mesh = place.mesh;
  return result;
}

template <template <bool, bool, bool> class Traversal = BinaryTraversal, class Hierarchy>
KERF_CUDA_INLINE Hit trace_closest(const Hierarchy& hierarchy, const MeshTable& meshes, const Ray* ray) {
  TracedRay traced;
  Traversal<false, false, false> traversal;
  trace(hierarchy, ray, traced, traversal);
  auto& search = traversal.search;
  if (search.open())
    search.nearest = decide<Traversal, false>(hierarchy, ray, traced.t_min, search.rival(), search.nearest);
  return named<Traversal>(hierarchy, meshes, ray, traced.may_be_far(), search.nearest);
}

template <template <bool, bool, bool> class Traversal = BinaryTraversal, class Hierarchy>
KERF_CUDA_INLINE bool trace_any(const Hierarchy& hierarchy, const Ray* ray) {
  TracedRay traced;
  Traversal<true, false, false> traversal;
  trace(hierarchy, ray, traced, traversal);
  auto& search = traversal.search;
  if (search.open())
    search.nearest = decide<Traversal, true>(hierarchy, ray, traced.t_min, search.rival(), search.nearest);
  return search.nearest.found();
}

}  // namespace kerf::cuda
