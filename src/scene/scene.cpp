// The handle of a scene, and how it is built.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <kerf/scene.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "base/uninitialized.hpp"
#include "construction/options.hpp"
#include "construction/sbvh/parallel_build.hpp"
#include "layout/top_level.hpp"
#include "math/coordinate_limit.hpp"
#include "scene/places.hpp"
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
  return !instance.scene.instances().empty();
}

// What stands at the place of an instance.
struct Inside {
  Box3f bounds;
  double condition, margin;  // of levels below

  explicit Inside(const Instance& instance) {
    if (has_scene(instance)) {
      const SceneStructure& scene = SceneStructure::of(instance.scene);
      bounds = scene.top.bounds;
      condition = scene.condition;
      margin = scene.margin;
    } else {
      bounds = Structure::of(instance.object).wide.bounds;
      condition = 1.0;
      margin = object_margin;
    }
  }
};

bool has_something(const Instance& instance) {
  return !(has_scene(instance) ? SceneStructure::of(instance.scene).top.empty()
                               : Structure::of(instance.object).wide.empty());
}

// An instance that is not empty, with its box in the scene.
struct Candidate {
  SceneStructure::Place place;
  Box3f box;
  double condition, margin;

  Candidate(const Instance& instance, std::uint32_t number) : Candidate(instance, number, Inside(instance)) {}
  Candidate(const Instance& instance, std::uint32_t number, const Inside& inside)
      : place(Placement(instance.transform, inside.bounds), instance, number),
        box(place.placement.box(instance.transform, inside.bounds)) {
    const double here = place.placement.condition(instance.transform);
    condition = here * inside.condition;
    margin = ray_margin(here, inside.margin);
  }

  bool is_in_range() const {
    return condition < Placement::max_condition && kerf::is_in_range(box.lower) &&
           kerf::is_in_range(box.upper);
  }
};

// Throws for the first of the instances that is refused.
void check(std::span<const Instance> instances) {
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const Instance& instance = instances[i];
    if (has_scene(instance) && !Structure::of(instance.object).wide.empty())
      raise(Error::invalid_argument, "instance %u has an object and a scene", i);
    if (!is_finite(instance.transform))
      raise(Error::invalid_argument, "the transform of instance %u has a number that is not finite", i);
    if (!has_something(instance)) continue;
    const Candidate candidate(instance, i);
    if (!(candidate.condition < Placement::max_condition)) {
      raise(Error::invalid_argument,
            "the transform of instance %u flattens its object, so that it cannot be inverted", i);
    }
    if (!candidate.is_in_range()) {
      raise(Error::invalid_argument,
            "the transform of instance %u moves its object to coordinates of %g and more", i,
            double{coordinate_limit});
    }
  }
}

// Numbers the instances, those of scenes at each place.
void number_instances(SceneStructure& scene) {
  std::uint64_t count = 0;
  const std::vector<Instance>& instances = scene.instances;
  if (std::none_of(instances.begin(), instances.end(), has_scene)) {
    scene.instance_count = static_cast<std::uint32_t>(instances.size());
    return;
  }
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

constexpr std::size_t instances_per_block = 1024;

std::shared_ptr<const SceneStructure> build_structure(std::span<const Instance> instances,
                                                      const BuildOptions& options) {
  if (instances.size() > ChildLink::max_place)
    raise(Error::too_large, "%zu instances are more than 2^28, which is more than kerf can number",
          instances.size());
  auto scene = std::make_shared<SceneStructure>();
  scene->instances.assign(instances.begin(), instances.end());
  scene->target = choose_target();
  number_instances(*scene);

  std::vector<std::uint32_t> present;  // the instances that are not empty
  present.reserve(instances.size());
  for (std::uint32_t i = 0; i < instances.size(); ++i)
    if (has_something(instances[i])) present.push_back(i);
  UninitializedVector<SceneStructure::Place> places(present.size());
  std::vector<Reference> references(present.size());
  std::atomic<bool> all_right = true;
  struct Worst {
    double condition = 1.0, margin = 0.0;
  };
  std::vector<Worst> worst((instances.size() + instances_per_block - 1) / instances_per_block);
  parallel_for(worst.size(), [&](std::size_t block) {
    const std::size_t begin = block * instances_per_block, end = begin + instances_per_block;
    for (std::size_t i = begin; i < std::min(end, instances.size()); ++i) {
      const Instance& instance = instances[i];
      if (!is_finite(instance.transform) ||
          (has_scene(instance) && !Structure::of(instance.object).wide.empty()))
        all_right = false;
    }
    for (std::size_t i = begin; i < std::min(end, present.size()); ++i) {
      const std::uint32_t index = present[i];
      const Candidate candidate(instances[index], scene->numbers.empty() ? index : scene->numbers[index]);
      if (!candidate.is_in_range()) all_right = false;
      places[i] = candidate.place;
      references[i] = Reference(candidate.box, static_cast<std::uint32_t>(i));
      worst[block].condition = std::max(worst[block].condition, candidate.condition);
      worst[block].margin = std::max(worst[block].margin, candidate.margin);
    }
  });
  if (!all_right) check(instances);
  for (const Worst& of_block : worst) {
    scene->condition = std::max(scene->condition, of_block.condition);
    scene->margin = std::max(scene->margin, of_block.margin);
  }

  BuildOptions object_splits = options;
  object_splits.max_leaf_size = 1;
  const BinaryTree tree = construct_object_split_tree(std::move(references), object_splits);
  TopLevel top = make_top_level(tree, choose_kernels().node_width, scene->target);
  scene->top = std::move(top.nodes);
  scene->places = UninitializedVector<SceneStructure::Place>(top.numbers.size());
  parallel_for_ranges(std::size_t{0}, top.numbers.size(), instances_per_block, [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) scene->places[i] = places[top.numbers[i]];
  });
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
  return structure_->instances;
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
    const auto work = [&] { return SceneStructure::share(build_structure(instances, options)); };
    constexpr std::size_t max_instances_of_one_task = 2048;
    return instances.size() <= max_instances_of_one_task ? on_this_thread(work)
                                                         : on_threads(options.threads, work);
  });
}

}  // namespace kerf
