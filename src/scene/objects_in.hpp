// The objects of a scene near a box.
#pragma once

#include <cstdint>

#include "math/box3f.hpp"
#include "scene/chain.hpp"
#include "scene/places.hpp"

namespace kerf {

/// Calls `visit(object, number, chain, local)` for the objects of all levels of which some part may lie in
/// `box`: the number of the instance, the way from it to the outermost scene, and a box in the object's space
/// that holds all of the object that, moved to the scene and rounded there, lies in `box`.
template <class Visit>
void visit_objects_in(const SceneStructure& scene, const Box3f& box, std::uint32_t first, const Chain* above,
                      const Visit& visit) {
  visit_places(scene, box, [&](const SceneStructure::Place& place) {
    const Instance& instance = scene.instance_of(place);
    const Chain chain{instance.transform, above};
    const Box3f& bounds = place.has_scene() ? place.scene().top.bounds : place.object().wide.bounds;
    const Box3f local = place.placement.to_object(box, instance.transform, bounds);
    if (local.empty()) return;
    const std::uint32_t number = first + place.number;
    if (place.has_scene()) {
      visit_objects_in(place.scene(), local, number, &chain, visit);
    } else {
      visit(place.object(), number, chain, local);
    }
  });
}

}  // namespace kerf
