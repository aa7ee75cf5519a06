// The build, stage after stage. `Executor` runs loops, sorts and sums: on the device, or on the host, where
// tests do the same with plain code.
#pragma once

#include <span>
#include <utility>

#include "../traversal.hpp"
#include "finish.hpp"
#include "input.hpp"

namespace kerf::cuda {

struct PlocOptions {
  float max_reference_ratio = 1.5f;
  std::uint32_t max_leaf_size = 8;
  std::uint32_t radius = 8;
};

/// What a build leaves: arrays of the executor.
template <class Executor>
struct BuiltHierarchy {
  typename Executor::template Array<PairNode> nodes;
  typename Executor::template Array<DeviceTriangle> triangles;  // of the leaves' references
  typename Executor::template Array<std::uint32_t> numbers;     // of these triangles
  Box bounds = empty_box();
  std::uint32_t references = 0, degenerate = 0, problems = 0;
  float cost = 0.0f;  // of the surface area heuristic
};

/// The most bytes of scratch memory that a build takes, `alignment` for each array, without what sorting and
/// summing need.
inline std::size_t scratch_bytes(std::size_t triangles, float max_reference_ratio, std::size_t alignment) {
  const auto references =
      static_cast<std::size_t>(static_cast<double>(max_reference_ratio) * static_cast<double>(triangles));
  const std::size_t per_triangle = sizeof(DeviceTriangle) + sizeof(Box) + 4 + 8 + 8;
  const std::size_t per_reference =
      sizeof(Reference) + 2 * 8 + 2 * 4 + 2 * sizeof(MergedNode) + 3 * 4 + 2 * 8;
  return triangles * per_triangle + references * per_reference + 20 * alignment + 64;
}

/// After so many rounds clusters merge with the neighbour whose number differs in the last bit, whatever the
/// boxes: then at most 28 rounds follow, and no path of the tree is longer than traversals can remember.
inline constexpr std::uint32_t max_rounds = 64;
static_assert(max_rounds + 28 < max_depth);

/// `meshes` lie where the executor works; together they have `count` triangles.
template <class Executor>
BuiltHierarchy<Executor> build_hierarchy(Executor& run, std::span<const InputMesh> meshes,
                                         std::uint32_t count, const PlocOptions& options) {
  using std::swap;
  BuiltHierarchy<Executor> out;
  if (count == 0) return out;
  auto triangles = run.template make<DeviceTriangle>(count);
  auto boxes = run.template make<Box>(count);
  auto problems = run.template make<std::uint32_t>(1);
  run.clear(problems);
  for (const InputMesh& mesh : meshes)
    run.for_each(mesh.triangle_count, ReadTriangle{mesh, triangles.data(), boxes.data(), problems.data()});
  out.bounds = run.bounds(boxes.data(), count, out.degenerate);
  out.problems = run.read(problems.data());
  if (out.problems != 0 || out.degenerate == count) return out;
  const Grid grid = grid_over(out.bounds);

  // The largest factor with which the triangles have no more references than are allowed.
  auto priorities = run.template make<std::uint32_t>(count);
  run.for_each(count, FindPriority{triangles.data(), boxes.data(), grid, priorities.data()});
  const auto allowed = static_cast<std::uint64_t>(static_cast<double>(options.max_reference_ratio) * count);
  CountReferences counted{boxes.data(), priorities.data(), 0};
  for (int bit = 20; bit >= 0 && allowed > count; --bit) {
    CountReferences more = counted;
    more.factor |= std::uint64_t{1} << bit;
    if (run.sum(count, more) <= allowed) counted = more;
  }
  auto sizes = run.template make<std::uint64_t>(count);
  auto firsts = run.template make<std::uint64_t>(count);
  run.for_each(count, WriteCounts{counted, sizes.data()});
  run.exclusive_sum(sizes.data(), firsts.data(), count);
  const auto room = static_cast<std::uint32_t>(run.sum(count, counted));
  auto references = run.template make<Reference>(room);
  run.for_each(count, SplitTriangles{triangles.data(), counted, firsts.data(), grid, references.data()});

  auto keys = run.template make<std::uint64_t>(room);
  auto order = run.template make<std::uint32_t>(room);
  run.for_each(room, FindKeys{references.data(), grid, keys.data(), order.data()});
  run.sort(keys, order, room);
  const auto n = static_cast<std::uint32_t>(run.sum(room, IsThere{references.data()}));
  out.references = n;

  auto nodes = run.template make<MergedNode>(2 * std::size_t{n} - 1);
  auto clusters = run.template make<std::uint32_t>(n);
  auto next_clusters = run.template make<std::uint32_t>(n);
  auto neighbour = run.template make<std::uint32_t>(n);
  auto marks = run.template make<std::uint64_t>(n + 1);
  auto before = run.template make<std::uint64_t>(n + 1);
  run.for_each(n, StartNode{references.data(), order.data(), grid.unit, nodes.data(), clusters.data()});
  std::uint32_t left = n, made = n;
  for (std::uint32_t round = 0; left > 1; ++round) {
    const std::uint32_t radius = round < max_rounds ? options.radius : 0;
    run.for_each(left,
                 FindNeighbour{nodes.data(), clusters.data(), left, radius, grid.unit, neighbour.data()});
    run.for_each(left, MarkMerges{neighbour.data(), left, marks.data()});
    run.exclusive_sum(marks.data(), before.data(), left + 1);
    run.for_each(left,
                 MergeClusters{nodes.data(), clusters.data(), neighbour.data(), marks.data(), before.data(),
                               next_clusters.data(), made, options.max_leaf_size, grid.unit});
    const std::uint64_t total = run.read(before.data() + left);
    made += static_cast<std::uint32_t>(total >> 32);
    left = static_cast<std::uint32_t>(total);
    swap(clusters, next_clusters);
  }

  const MergedNode root = run.read(nodes.data() + (2 * std::size_t{n} - 2));
  out.cost = root.cost / standard_max(half_area(root.box, grid.unit), FLT_MIN);
  out.triangles = run.template keep<DeviceTriangle>(n);
  out.numbers = run.template keep<std::uint32_t>(n);
  out.nodes = run.template keep<PairNode>(standard_max(root.inner, 1u));
  run.for_each(n, PlaceReference{nodes.data(), triangles.data(), out.triangles.data(), out.numbers.data()});
  if (root.inner == 0)
    run.for_each(1, PlaceLeaf{nodes.data(), 2 * n - 2, out.nodes.data()});
  else
    run.for_each(n - 1, PlaceNode{nodes.data(), n, out.nodes.data()});
  return out;
}

}  // namespace kerf::cuda
