// What a `Scene` holds.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <kerf/scene.hpp>

#include "base/uninitialized.hpp"
#include "layout/wide_bvh.hpp"
#include "math/placement.hpp"
#include "simd/dispatch.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"
#include "traversal/rays/leaf_visits.hpp"

namespace kerf {

struct SceneStructure {
  /// What a ray reads of an instance: two cache lines.
  struct alignas(64) Place {
    Placement placement;
    const Structure* object;  ///< not empty
    std::uint32_t number;     ///< of the instance
  };
  static_assert(sizeof(Place) == 128);

  std::vector<Instance> instances;    ///< as given: they keep the objects
  UninitializedVector<Place> places;  ///< of those whose objects are not empty, in the order of leaves
  WideBvh top;                        ///< its leaves are places
  float margin = 0.0f;                ///< for `visit_leaves`
  Target target{};

  static const SceneStructure& of(const Scene& scene) { return *scene.structure_; }
  static Scene share(std::shared_ptr<const SceneStructure> structure) { return Scene(std::move(structure)); }
};

inline constexpr float end_of_ray = -std::numeric_limits<float>::infinity();

/// Calls `visit(place)` with the places of a scene that the ray may meet, the nearest boxes first. It returns
/// the t up to which the ray goes on, or `end_of_ray`.
template <class Visit>
void visit_places(const SceneStructure& scene, const Ray& ray, Visit&& visit) {
  if (scene.top.empty()) return;
  auto visit_leaf = [&](ChildLink leaf) {
    float limit = end_of_ray;
    for (std::uint32_t i = leaf.first(); i < leaf.first() + leaf.count(); ++i) {
      limit = visit(scene.places[i]);
      if (limit == end_of_ray) break;
    }
    return limit;
  };
  using VisitLeaf = decltype(visit_leaf);
  visit_leaves(scene.target, scene.top, ray, scene.margin, &visit_leaf,
               [](void* visitor, ChildLink leaf) { return (*static_cast<VisitLeaf*>(visitor))(leaf); });
}

}  // namespace kerf
