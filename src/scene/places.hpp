// What a `Scene` holds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <kerf/scene.hpp>

#include "base/shared_pointer.hpp"
#include "base/small_vector.hpp"
#include "base/uninitialized.hpp"
#include "layout/wide_bvh.hpp"
#include "math/box3f.hpp"
#include "scene/instance_array.hpp"
#include "scene/placement.hpp"
#include "simd/dispatch.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"
#include "traversal/rays/leaf_visits.hpp"

namespace kerf {

struct SceneStructure {
  /// What a ray reads of an instance: two cache lines.
  class alignas(64) Place {
   public:
    /// All but the placement.
    void set(const Instance& instance, std::uint32_t first_number) {
      const SceneStructure& scene = SceneStructure::of(instance.scene);
      const bool is_object = scene.instances.empty();
      const void* const inside =
          is_object ? static_cast<const void*>(&Structure::of(instance.object)) : &scene;
      inside_ = reinterpret_cast<std::uintptr_t>(inside) | (is_object ? 0u : 1u);
      number = first_number;
      mask = instance.mask.bits;
    }

    Placement placement;
    std::uint32_t number;  ///< of the instance, or of the first instance of the scene that stands here
    std::uint32_t mask;    ///< the bits

    bool has_scene() const { return (inside_ & 1) != 0; }
    const Structure& object() const { return *reinterpret_cast<const Structure*>(inside_); }
    const SceneStructure& scene() const { return *reinterpret_cast<const SceneStructure*>(inside_ - 1); }

   private:
    std::uintptr_t inside_;  // the address of one of them; the lowest bit is set for a scene
  };
  static_assert(sizeof(Place) == 128 && alignof(Structure) > 1);

  InstanceArray instances;             ///< as given: they keep the objects
  std::vector<std::uint32_t> numbers;  ///< the first of each instance; none if they are 0, 1, 2...
  std::uint32_t instance_count = 0;    ///< with those of scenes
  unsigned levels = 1;
  UninitializedVector<Place> places;  ///< of those that are not empty, in the order of leaves
  WideBvh top;                        ///< its leaves are places
  double condition = 1.0;             ///< the worst, those of all levels multiplied
  double margin = 0.0;                ///< for `visit_leaves`
  Target target{};

  /// Which of `instances` the number stands in.
  std::uint32_t index_of(std::uint32_t number) const {
    if (numbers.empty()) return number;
    const auto above = std::upper_bound(numbers.begin(), numbers.end(), number);
    return static_cast<std::uint32_t>(above - numbers.begin()) - 1;
  }
  const Instance& instance_of(const Place& place) const { return instances[index_of(place.number)]; }

  static const SceneStructure& of(const Scene& scene) {
    return *SharedPointer<SceneStructure>::in(scene.structure_);
  }
  static Scene share(std::shared_ptr<const SceneStructure> structure) {
    return Scene(SharedPointer<SceneStructure>::share(std::move(structure)));
  }
};

inline constexpr float end_of_ray = -std::numeric_limits<float>::infinity();

/// What a ray meets: an instance's object, and itself there.
struct MetObject {
  const SceneStructure& scene;         ///< in which the instance stands
  const SceneStructure::Place& place;  ///< of the instance; never of a scene
  const MovedRay& ray;                 ///< its t_max is the limit
  std::uint32_t number;                ///< of the instance, counted over all levels

  const Structure& object() const { return place.object(); }
  const Bvh& bvh() const { return scene.instance_of(place).object; }
};

/// Calls `visit(met)` with the objects of a scene that the ray may meet, the nearest boxes first, but for
/// those of places that share no bit with the mask if there is one. It returns the t up to which the ray goes
/// on, in the outermost scene, or `end_of_ray`. `limit` is the last of them.
template <class Visit>
void visit_objects(const SceneStructure& scene, const MovedRay& ray, std::uint32_t first, const Mask* mask,
                   float& limit, const Visit& visit) {
  if (scene.top.empty()) return;
  auto visit_leaf = [&](ChildLink leaf) {
    for (std::uint32_t i = leaf.first(); i < leaf.first() + leaf.count(); ++i) {
      const SceneStructure::Place& place = scene.places[i];
      if (mask != nullptr && (place.mask & mask->bits) == 0) continue;
      MovedRay local = place.placement.to_object(ray.ray);
      local.unit *= ray.unit;
      local.ray.t_max = local.in_object(limit);
      if (place.has_scene()) {
        visit_objects(place.scene(), local, first + place.number, mask, limit, visit);
      } else {
        limit = visit(MetObject{scene, place, local, first + place.number});
      }
      if (limit == end_of_ray) return end_of_ray;
    }
    return ray.in_object(limit);
  };
  using VisitLeaf = decltype(visit_leaf);
  visit_leaves(scene.target, scene.top, ray.ray, static_cast<float>(scene.margin), &visit_leaf,
               [](void* visitor, ChildLink leaf) { return (*static_cast<VisitLeaf*>(visitor))(leaf); });
}

template <class Visit>
void visit_objects(const SceneStructure& scene, const Ray& ray, const Mask* mask, const Visit& visit) {
  float limit = ray.t_max;
  visit_objects(scene, MovedRay(ray), 0, mask, limit, visit);
}

/// Calls `visit(place)` for the places of a scene whose boxes have a point in `box`, not those of the scenes
/// there. Throws `std::bad_alloc`.
template <class Visit>
void visit_places(const SceneStructure& scene, const Box3f& box, const Visit& visit) {
  if (scene.top.empty()) return;
  with_width(scene.top.width, [&](auto width) {
    SmallVector<ChildLink, 1024> waiting;
    waiting.push_back(ChildLink::node(0));
    while (!waiting.empty()) {
      const auto& node = scene.top.nodes<WideNode<width>>()[waiting.back().node()];
      waiting.pop_back();
      for (std::uint32_t slot = 0; slot < width; ++slot) {
        if (intersect(child_box(node, slot), box).empty()) continue;
        const ChildLink child = node.children[slot];
        if (!child.is_leaf()) {
          waiting.push_back(child);
          continue;
        }
        for (std::uint32_t i = child.first(); i < child.first() + child.count(); ++i) visit(scene.places[i]);
      }
    }
  });
}

}  // namespace kerf
