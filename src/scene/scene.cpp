// The handle of a scene, and how it is built.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <hwy/cache_control.h>
#include <kerf/scene.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "base/uninitialized.hpp"
#include "construction/options.hpp"
#include "math/coordinate_limit.hpp"
#include "scene/places.hpp"
#include "scene/top_level.hpp"
#include "simd/dispatch.hpp"
#include "traversal/dispatch.hpp"
#include "tree/reference.hpp"

namespace kerf {
namespace {

Shared<SceneStructure> nothing() noexcept {
  static const SceneStructure structure;
  return SharedPointer<SceneStructure>::share({std::shared_ptr<const void>(), &structure});
}

bool is_finite(const Transform& transform) {
  for (const auto& row : transform.rows)
    for (const double x : row)
      if (!std::isfinite(x)) return false;
  return true;
}

bool has_scene(const Instance& instance) {
  return !SceneStructure::of(instance.scene).instances.empty();
}

// What stands at the place of an instance.
const WideBvh& inside(const Instance& instance) {
  const SceneStructure& scene = SceneStructure::of(instance.scene);
  return scene.instances.empty() ? Structure::of(instance.object).wide : scene.top;
}

bool is_in_range(const Box3f& box) {
  return kerf::is_in_range(box.lower) && kerf::is_in_range(box.upper);
}

// The condition of all levels, and the margin that rays need here.
struct Worst {
  double condition = 1.0, margin = 0.0;

  Worst() = default;
  Worst(const Instance& instance, double condition_here) : condition(condition_here), margin(object_margin) {
    if (has_scene(instance)) {
      const SceneStructure& scene = SceneStructure::of(instance.scene);
      condition *= scene.condition;
      margin = scene.margin;
    }
    margin = ray_margin(condition_here, margin);
  }
  void take(const Worst& other) {
    condition = std::max(condition, other.condition);
    margin = std::max(margin, other.margin);
  }
};

// Throws for the first of the instances that is refused.
void check(std::span<const Instance> instances) {
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const Instance& instance = instances[i];
    const Transform& transform = instance.transform;
    if (has_scene(instance) && !Structure::of(instance.object).wide.empty())
      raise(Error::invalid_argument, "instance %u has an object and a scene", i);
    if (!is_finite(transform))
      raise(Error::invalid_argument, "the transform of instance %u has a number that is not finite", i);
    if (inside(instance).empty()) continue;
    const Box3f& bounds = inside(instance).bounds;
    if (!(Worst(instance, place_object(transform, bounds).condition).condition <
          PlacedObject::max_condition)) {
      raise(Error::invalid_argument,
            "the transform of instance %u flattens its object, so that it cannot be inverted", i);
    }
    if (!is_in_range(place_box(transform, bounds))) {
      raise(Error::invalid_argument,
            "the transform of instance %u moves its object to coordinates of %g and more", i,
            double{coordinate_limit});
    }
  }
}

// Numbers the instances, those of scenes at each place.
void number_instances(SceneStructure& scene) {
  std::uint64_t count = 0;
  const InstanceArray& instances = scene.instances;
  scene.numbers.reserve(instances.size());
  for (const Instance& instance : instances) {
    scene.numbers.push_back(static_cast<std::uint32_t>(count));
    const bool nested = has_scene(instance);
    count += nested ? SceneStructure::of(instance.scene).instance_count : 1;
    if (count >= invalid_id)
      raise(Error::too_large, "with those of scenes in it, a scene has 2^32 - 1 instances or more");
    if (nested) scene.levels = std::max(scene.levels, SceneStructure::of(instance.scene).levels + 1);
  }
  if (scene.levels > max_scene_levels)
    raise(Error::too_large, "%u levels of scenes are more than %u", scene.levels, max_scene_levels);
  scene.instance_count = static_cast<std::uint32_t>(count);
}

// As many are handed to vectors at a time.
constexpr std::size_t chunk = 64;

// What there is in a block of instances.
struct Block {
  std::uint32_t present = 0;  // those that are not empty
  bool has_scenes = false;
  bool is_right = true;
};

// Copies a block of instances, and writes references to those that are not empty. A number that is not finite
// in the transform of one makes its box that, or infinite.
Block take_block(std::span<const Instance> instances, std::size_t number, SceneStructure& scene,
                 Reference* references) {
  Block block;
  InstanceArray& copies = scene.instances;
  copies.copy(instances, number);
  PlacedBox placed[chunk];
  Box3f boxes[chunk];
  for (std::size_t first = copies.begin_of(number); first < copies.end_of(number); first += chunk) {
    Reference* const to = references + block.present;
    std::size_t count = 0;
    for (std::size_t i = first; i < std::min(first + chunk, copies.end_of(number)); ++i) {
      const Instance& instance = copies[i];
      const WideBvh& wide = inside(instance);
      if (has_scene(instance)) {
        block.has_scenes = true;
        block.is_right = block.is_right && Structure::of(instance.object).wide.empty();
      }
      if (wide.empty()) {
        block.is_right = block.is_right && is_finite(instance.transform);
        continue;
      }
      to[count].primitive = static_cast<std::uint32_t>(i);
      placed[count++] = {&instance.transform, &wide.bounds};
    }
    place_boxes(scene.target, {placed, count}, boxes);
    for (std::size_t i = 0; i < count; ++i) {
      block.is_right = block.is_right && is_in_range(boxes[i]);
      to[i] = Reference(boxes[i], to[i].primitive);
    }
    block.present += static_cast<std::uint32_t>(count);
  }
  return block;
}

void prefetch(const Instance& instance) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&instance);
  for (std::size_t i = 0; i < sizeof instance; i += 64) hwy::Prefetch(bytes + i);
}

// Writes the places of the instances with these indices, which are anywhere in memory.
Worst write_places(const SceneStructure& scene, std::span<const std::uint32_t> indices,
                   SceneStructure::Place* places) {
  Worst worst;
  PlacedBox placed[chunk];
  Placement* placements[chunk];
  double conditions[chunk];
  for (std::size_t first = 0; first < indices.size(); first += chunk) {
    const std::size_t count = std::min(chunk, indices.size() - first);
    for (const std::uint32_t index :
         indices.subspan(first + count, std::min(chunk, indices.size() - first - count)))
      prefetch(scene.instances[index]);
    for (std::size_t i = 0; i < count; ++i) {
      const Instance& instance = scene.instances[indices[first + i]];
      placed[i] = {&instance.transform, &inside(instance).bounds};
      placements[i] = &places[first + i].placement;
    }
    place_objects(scene.target, {placed, count}, placements, conditions);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t index = indices[first + i];
      const Instance& instance = scene.instances[index];
      worst.take(Worst(instance, conditions[i]));
      places[first + i].set(instance, scene.numbers.empty() ? index : scene.numbers[index]);
    }
  }
  return worst;
}

std::shared_ptr<const SceneStructure> build_structure(std::span<const Instance> instances) {
  if (instances.size() > ChildLink::max_place)
    raise(Error::too_large, "%zu instances are more than 2^28, which is more than kerf can number",
          instances.size());
  auto scene = std::make_shared<SceneStructure>();
  scene->target = choose_target();
  InstanceArray& copies = scene->instances;
  copies.reserve(instances.size());

  UninitializedVector<Reference> references(instances.size());
  std::vector<Block> blocks(copies.blocks());
  parallel_for(blocks.size(), [&](std::size_t i) {
    blocks[i] = take_block(instances, i, *scene, references.data() + copies.begin_of(i));
  });
  bool has_scenes = false, is_right = true;
  std::size_t present = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Reference* const first = references.data() + copies.begin_of(i);
    if (present != copies.begin_of(i)) std::copy_n(first, blocks[i].present, references.data() + present);
    present += blocks[i].present;
    has_scenes = has_scenes || blocks[i].has_scenes;
    is_right = is_right && blocks[i].is_right;
  }
  if (!is_right) check(instances);
  scene->instance_count = static_cast<std::uint32_t>(instances.size());
  if (has_scenes) number_instances(*scene);

  UninitializedVector<std::uint32_t> indices(present);
  scene->top = build_top_level({references.data(), present}, indices.data(), choose_kernels().node_width,
                               scene->target);
  scene->places = UninitializedVector<SceneStructure::Place>(present);
  std::vector<Worst> worst((present + InstanceArray::block - 1) / InstanceArray::block);
  parallel_for(worst.size(), [&](std::size_t i) {
    const std::size_t begin = i * InstanceArray::block, end = std::min(begin + InstanceArray::block, present);
    worst[i] = write_places(*scene, {indices.data() + begin, end - begin}, scene->places.data() + begin);
  });
  for (const Worst& of_block : worst) {
    scene->condition = std::max(scene->condition, of_block.condition);
    scene->margin = std::max(scene->margin, of_block.margin);
  }
  if (!(scene->condition < PlacedObject::max_condition)) check(instances);
  return scene;
}

}  // namespace

template class Shared<SceneStructure>;

Scene::Scene() noexcept : structure_(nothing()) {}
Scene::Scene(Shared<SceneStructure> structure) noexcept : structure_(std::move(structure)) {}
Scene::Scene(Scene&& other) noexcept : structure_(std::exchange(other.structure_, nothing())) {}
Scene& Scene::operator=(Scene&& other) noexcept {
  structure_ = std::exchange(other.structure_, nothing());
  return *this;
}

std::span<const Instance> Scene::instances() const {
  return {structure_->instances.data(), structure_->instances.size()};
}
std::uint32_t Scene::instance_count() const {
  return structure_->instance_count;
}
std::vector<std::uint32_t> Scene::path(std::uint32_t instance) const {
  if (instance >= structure_->instance_count) {
    raise(Error::invalid_argument, "instance %u is not below the number of instances, %u", instance,
          structure_->instance_count);
  }
  return report_out_of_memory([&] {
    std::vector<std::uint32_t> path;
    for (const SceneStructure* scene = structure_.get();;) {
      const std::uint32_t index = scene->index_of(instance);
      path.push_back(index);
      const Scene& inside = scene->instances[index].scene;
      if (inside.instances().empty()) return path;
      instance -= scene->numbers[index];
      scene = &SceneStructure::of(inside);
    }
  });
}
Box3f Scene::bounds() const {
  return structure_->top.bounds;
}
std::size_t Scene::bytes() const {
  const SceneStructure& scene = *structure_;
  return scene.instances.size() * sizeof(Instance) + scene.places.size() * sizeof(SceneStructure::Place) +
         scene.numbers.size() * sizeof(std::uint32_t) + scene.top.node_bytes();
}

Scene build(std::span<const Instance> instances, const BuildOptions& options) {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    check_options(options);
    const auto work = [&] { return SceneStructure::share(build_structure(instances)); };
    constexpr std::size_t max_instances_of_one_task = 2048;
    return instances.size() <= max_instances_of_one_task ? on_this_thread(work)
                                                         : on_threads(options.threads, work);
  });
}

}  // namespace kerf
