// Scene against scene, and a scene against itself.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include <kerf/scene.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "math/motion.hpp"
#include "queries/batches.hpp"
#include "queries/pairs.hpp"
#include "scene/chain.hpp"
#include "scene/objects_in.hpp"
#include "scene/placement.hpp"
#include "scene/places.hpp"

namespace kerf {
namespace {

// An object of any level, and the way from it to the frame in which both scenes stand.
struct Placed {
  const Structure* object;
  std::uint32_t number;
  Transform whole;
};

// Two objects whose boxes meet, the second moved to the space of the first.
struct ObjectPair {
  const Structure* first;
  const Structure* second;
  std::uint32_t first_number, second_number;
  Transform to_first;
};

Box3f grown(const Box3f& box, double margin) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box3f larger;
  for (int axis = 0; axis < 3; ++axis) {
    larger.lower[axis] = std::nextafter(static_cast<float>(box.lower[axis] - margin), -infinity);
    larger.upper[axis] = std::nextafter(static_cast<float>(box.upper[axis] + margin), infinity);
  }
  return larger;
}

double largest_extent(const Box3f& box) {
  const Vec3f size = extent(box);
  return std::max({double{size.x}, double{size.y}, double{size.z}});
}

// By how much a point of something of this size may lie off in the scene, where its corners are rounded in
// the space of an object of `scene`. What comes of the object's own size is in the boxes of places. The
// inverse map is off by the square of the condition.
double margin_of(const SceneStructure& scene, double size) {
  return 0x1p-22 * scene.condition * size +
         0x1p-50 * scene.condition * scene.condition * (size + largest_extent(scene.top.bounds));
}

// The objects of `other`, moved by `transform`; perhaps without those that are far from `scene`.
std::vector<Placed> list_objects(const SceneStructure& other, const Transform& transform,
                                 const SceneStructure& scene) {
  std::vector<Placed> objects;
  if (other.top.empty() || scene.top.empty()) return objects;
  const Box3f& bounds = other.top.bounds;
  const Box3f moved_bounds = checked_motion(transform, bounds)(bounds);
  const Box3f common =
      intersect(moved_bounds, grown(scene.top.bounds, margin_of(scene, largest_extent(moved_bounds))));
  if (common.empty()) return objects;
  const PlacedObject placed = place_object(transform, bounds);
  const Box3f near = placed.is_invertible() ? placed.placement.to_object(common, transform, bounds) : bounds;
  if (near.empty()) return objects;
  const Chain moved{transform, nullptr};
  visit_objects_in(other, near, 0, &moved,
                   [&](const Structure& object, std::uint32_t number, const Chain& chain, const Box3f&) {
                     objects.push_back({&object, number, chain.whole()});
                   });
  return objects;
}

// Calls `visit(pair)` for the objects of `scene` that may touch `second`.
template <class Visit>
void visit_object_pairs(const SceneStructure& scene, const Placed& second, const Visit& visit) {
  const Box3f& bounds = second.object->wide.bounds;
  const Box3f moved = checked_motion(second.whole, bounds)(bounds);
  visit_objects_in(
      scene, grown(moved, margin_of(scene, largest_extent(moved))), 0, nullptr,
      [&](const Structure& first, std::uint32_t number, const Chain& chain, const Box3f&) {
        const Placement placement = place_object(chain.whole(), first.wide.bounds).placement;
        visit(ObjectPair{&first, second.object, number, second.number, placement.to_object(second.whole)});
      });
}

bool boxes_meet(const ObjectPair& pair, const Motion& motion) {
  return !intersect(pair.first->wide.bounds, motion(pair.second->wide.bounds)).empty();
}

// The pairs of `scene` with `others`, or with itself: then those of a lower with a higher instance.
std::vector<SceneTouchingPair> find_pairs(const SceneStructure& scene, const std::vector<Placed>& others,
                                          bool is_itself, const BatchOptions& options) {
  constexpr std::size_t objects_per_batch = 16;
  std::vector<std::vector<ObjectPair>> lists((others.size() + objects_per_batch - 1) / objects_per_batch);
  for_each_batch(lists.size(), 1, options, [&](std::size_t list, std::size_t) {
    const std::size_t end = std::min(others.size(), (list + 1) * objects_per_batch);
    for (std::size_t i = list * objects_per_batch; i < end; ++i) {
      visit_object_pairs(scene, others[i], [&](const ObjectPair& pair) {
        if (!is_itself || pair.first_number < pair.second_number) lists[list].push_back(pair);
      });
    }
  });
  std::vector<ObjectPair> pairs;
  for (const std::vector<ObjectPair>& list : lists) pairs.insert(pairs.end(), list.begin(), list.end());

  // Few pairs of large objects are divided, so that threads which are done early find more to do.
  constexpr std::size_t wanted_parts = 512;
  const std::size_t parts_per_pair = wanted_parts / std::max<std::size_t>(pairs.size(), 1);
  struct Part {
    std::size_t pair;
    BoxPair start;
  };
  std::vector<Part> parts;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const WideBvh &first = pairs[i].first->wide, &second = pairs[i].second->wide;
    const Motion motion = checked_motion(pairs[i].to_first, second.bounds);
    if (!boxes_meet(pairs[i], motion)) continue;
    const BoxPair root = root_pair(first, second, motion);
    if (parts_per_pair < 2) {
      parts.push_back({i, root});
      continue;
    }
    for (const BoxPair& start :
         pairs[i].first->kernels->open_pairs(first, second, motion, root, parts_per_pair))
      parts.push_back({i, start});
  }
  std::vector<std::vector<SceneTouchingPair>> found(parts.size());
  for_each_batch(parts.size(), 1, options, [&](std::size_t part, std::size_t) {
    const ObjectPair& pair = pairs[parts[part].pair];
    const WideBvh &first = pair.first->wide, &second = pair.second->wide;
    visit_pairs(*pair.first->kernels, first, second, Motion(pair.to_first, second.bounds), parts[part].start,
                [&](std::uint32_t a, std::uint32_t b) {
                  const PrimitiveId id_a = locate(*pair.first, a), id_b = locate(*pair.second, b);
                  found[part].push_back({{id_a.primitive, id_a.mesh, pair.first_number},
                                         {id_b.primitive, id_b.mesh, pair.second_number}});
                  return true;
                });
  });
  std::vector<SceneTouchingPair> all;
  for (const std::vector<SceneTouchingPair>& part : found) all.insert(all.end(), part.begin(), part.end());
  const auto key = [](const SceneTouchingPair& pair) {
    const auto& [a, b] = pair;
    return std::tuple(a.instance, a.mesh, a.primitive, b.instance, b.mesh, b.primitive);
  };
  std::sort(all.begin(), all.end(),
            [&](const SceneTouchingPair& a, const SceneTouchingPair& b) { return key(a) < key(b); });
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

Scene scene_of(const Bvh& bvh) {
  const Instance alone{.object = bvh};
  return build(std::span(&alone, 1), {.threads = 1});
}

}  // namespace

bool Scene::touches(const Scene& other, const Transform& transform) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    bool found = false;
    for (const Placed& second : list_objects(*other.structure_, transform, *structure_)) {
      visit_object_pairs(*structure_, second, [&](const ObjectPair& pair) {
        if (found) return;
        const WideBvh &a = pair.first->wide, &b = pair.second->wide;
        const Motion motion = checked_motion(pair.to_first, b.bounds);
        if (!boxes_meet(pair, motion)) return;
        visit_pairs(*pair.first->kernels, a, b, motion, root_pair(a, b, motion),
                    [&](std::uint32_t, std::uint32_t) {
                      found = true;
                      return false;
                    });
      });
      if (found) break;
    }
    return found;
  });
}

bool Scene::touches(const Bvh& other, const Transform& transform) const {
  return touches(scene_of(other), transform);
}

std::vector<SceneTouchingPair> Scene::touching_pairs(const Scene& other, const Transform& transform,
                                                     const BatchOptions& options) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    const std::vector<Placed> others = list_objects(*other.structure_, transform, *structure_);
    return find_pairs(*structure_, others, false, options);
  });
}

std::vector<SceneTouchingPair> Scene::touching_pairs(const Bvh& other, const Transform& transform,
                                                     const BatchOptions& options) const {
  return touching_pairs(scene_of(other), transform, options);
}

std::vector<SceneTouchingPair> Scene::touching_pairs(const BatchOptions& options) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    const std::vector<Placed> all = list_objects(*structure_, {}, *structure_);
    return find_pairs(*structure_, all, true, options);
  });
}

}  // namespace kerf
