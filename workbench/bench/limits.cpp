#include "workbench/bench/limits.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <vector>

#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

namespace workbench {
namespace {

using namespace kerf;

// A run takes some microseconds, so that the best of many runs is undisturbed.
constexpr std::size_t steps_per_run = 2000;
constexpr int runs = 200;

template <class Run>
double best_ns_per_step(const Run& run) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return 1e9 * best / steps_per_run;
}

// Thirty-two layers of one triangle each, one behind another along z. They make a node with several leaves,
// all of which a ray along z meets.
Bvh layers() {
  constexpr std::uint32_t count = 32;
  std::vector<Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto z = static_cast<float>(i);
    vertices.insert(vertices.end(), {{0.0f, 0.0f, z}, {1.0f, 0.0f, z}, {0.0f, 1.0f, z}});
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return build({.vertices = vertices, .triangles = triangles});
}

}  // namespace

StepTimes measure_steps() {
  const Bvh bvh = layers();
  // Through the boxes of the layers, but beside their triangles.
  const Ray ray{.origin = {0.9f, 0.9f, -1.0f}, .direction = {0.01f, 0.01f, 1.0f}};
  const Layout arrays = layout(bvh);
  ChildLink leaf = ChildLink::node(0);
  while (!leaf.is_leaf()) leaf = arrays.child(leaf.node(), 0);
  StepTimes times;
  times.node_ns = best_ns_per_step([&] { repeat_node_steps(bvh, ray, steps_per_run); });
  times.leaf_ns = best_ns_per_step([&] { repeat_leaf_tests(bvh, ray, leaf, steps_per_run); });
  return times;
}

StepCounts count_steps(const Bvh& bvh, const RaySet& set) {
  TraversalCounters counters;
  for (const Ray& ray : set.rays) {
    if (set.any_hit()) {
      occluded(bvh, ray, counters);
    } else {
      intersect(bvh, ray, counters);
    }
  }
  const double rays = static_cast<double>(std::max<std::size_t>(set.rays.size(), 1));
  return {.nodes = static_cast<double>(counters.steps) / rays,
          .leaves = static_cast<double>(counters.leaves) / rays};
}

}  // namespace workbench
