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

std::shared_ptr<const SceneStructure> nothing() noexcept {
  static const SceneStructure structure;
  return {std::shared_ptr<const void>(), &structure};
}

bool is_finite(const Transform& transform) {
  for (const auto& row : transform.rows)
    for (const double x : row)
      if (!std::isfinite(x)) return false;
  return true;
}

// An instance whose object is not empty.
struct Candidate {
  SceneStructure::Place place;
  Box3f box;
  double condition;

  Candidate(const Instance& instance, std::uint32_t number)
      : place{Placement(instance.transform, Structure::of(instance.object).wide.bounds),
              &Structure::of(instance.object), number},
        box(place.placement.box(instance.transform, place.object->wide.bounds)),
        condition(place.placement.condition(instance.transform)) {}

  bool is_in_range() const {
    return condition < Placement::max_condition && kerf::is_in_range(box.lower) &&
           kerf::is_in_range(box.upper);
  }
};

// Throws for the first of the instances that is refused.
void check(std::span<const Instance> instances) {
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    if (!is_finite(instances[i].transform))
      raise(Error::invalid_argument, "the transform of instance %u has a number that is not finite", i);
    if (Structure::of(instances[i].object).wide.empty()) continue;
    const Candidate candidate(instances[i], i);
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

constexpr std::size_t instances_per_block = 1024;

std::shared_ptr<const SceneStructure> build_structure(std::span<const Instance> instances,
                                                      const BuildOptions& options) {
  if (instances.size() > ChildLink::max_place)
    raise(Error::too_large, "%zu instances are more than 2^28, which is more than kerf can number",
          instances.size());
  auto scene = std::make_shared<SceneStructure>();
  scene->instances.assign(instances.begin(), instances.end());
  scene->target = choose_target();

  std::vector<std::uint32_t> numbers;  // of the instances that are not empty
  numbers.reserve(instances.size());
  for (std::uint32_t i = 0; i < instances.size(); ++i)
    if (!Structure::of(instances[i].object).wide.empty()) numbers.push_back(i);
  UninitializedVector<SceneStructure::Place> places(numbers.size());
  std::vector<Reference> references(numbers.size());
  std::atomic<bool> all_in_range = true;
  const std::size_t blocks = (instances.size() + instances_per_block - 1) / instances_per_block;
  std::vector<double> conditions(blocks, 1.0);
  parallel_for(blocks, [&](std::size_t block) {
    const std::size_t begin = block * instances_per_block;
    for (std::size_t i = begin; i < std::min(begin + instances_per_block, instances.size()); ++i)
      if (!is_finite(instances[i].transform)) all_in_range = false;
    for (std::size_t i = begin; i < std::min(begin + instances_per_block, numbers.size()); ++i) {
      const Candidate candidate(instances[numbers[i]], numbers[i]);
      if (!candidate.is_in_range()) {
        all_in_range = false;
        return;
      }
      places[i] = candidate.place;
      references[i] = Reference(candidate.box, static_cast<std::uint32_t>(i));
      conditions[block] = std::max(conditions[block], candidate.condition);
    }
  });
  if (!all_in_range) check(instances);
  scene->margin = static_cast<float>(
      ray_margin(blocks == 0 ? 1.0 : *std::max_element(conditions.begin(), conditions.end())));

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

Scene::Scene() noexcept : structure_(nothing()) {}
Scene::Scene(std::shared_ptr<const SceneStructure> structure) noexcept : structure_(std::move(structure)) {}
Scene::Scene(Scene&& other) noexcept : structure_(std::exchange(other.structure_, nothing())) {}
Scene& Scene::operator=(Scene&& other) noexcept {
  structure_ = std::exchange(other.structure_, nothing());
  return *this;
}

std::span<const Instance> Scene::instances() const {
  return structure_->instances;
}
Box3f Scene::bounds() const {
  return structure_->top.bounds;
}
std::size_t Scene::bytes() const {
  const SceneStructure& scene = *structure_;
  return scene.instances.size() * sizeof(Instance) + scene.places.size() * sizeof(SceneStructure::Place) +
         scene.top.node_bytes();
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
