#include "refinement/sample_ways.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "refinement/way.hpp"

namespace kerf {
namespace {

// Where all triangles lie over one another, the first few rays are too many already.
constexpr std::size_t min_rays_per_batch = 128, max_rays_per_batch = 8192, rays_per_task = 64;

// Returns how many boxes and triangles were looked at.
std::uint64_t end_at_hit(const BinaryTree& tree, const Geometry& geometry, Ray& ray) {
  struct Waiting {
    float enter;
    std::uint32_t node;
  };
  std::array<Waiting, max_tree_depth + 1> stack;
  std::size_t count = 0;
  std::uint64_t work = 0;
  Way way(ray);
  stack[count++] = {way.enter(tree.nodes[0].bounds), 0};
  while (count != 0) {
    const Waiting next = stack[--count];
    if (next.enter == std::numeric_limits<float>::infinity() || next.enter > way.t_max()) continue;
    const BinaryNode& node = tree.nodes[next.node];
    if (node.is_leaf()) {
      work += node.count;
      for (std::uint32_t i = 0; i < node.count; ++i)
        way.end_at(geometry.triangle(tree.references[node.first + i]));
      continue;
    }
    work += 2;
    const Waiting left{way.enter(tree.nodes[node.left()].bounds), node.left()};
    const Waiting right{way.enter(tree.nodes[node.right()].bounds), node.right()};
    const bool left_first = left.enter <= right.enter;
    stack[count++] = left_first ? right : left;
    stack[count++] = left_first ? left : right;
  }
  ray.t_max = way.t_max();
  return work;
}

}  // namespace

std::vector<Ray> pick_samples(std::span<const Ray> rays) {
  const std::size_t count = std::min(rays.size(), max_sample_rays);
  std::vector<Ray> samples(count);
  for (std::size_t i = 0; i < count; ++i)
    samples[i] = rays[static_cast<std::size_t>(std::uint64_t{i} * rays.size() / count)];
  return samples;
}

std::vector<Ray> trace_to_hits(const BinaryTree& tree, const Geometry& geometry, std::span<const Ray> rays,
                               const std::function<bool(float)>& progress, std::uint64_t max_work) {
  if (tree.empty()) return {};
  std::vector<Ray> ways = pick_samples(rays);
  const std::size_t count = ways.size();
  std::atomic<std::uint64_t> work = 0;
  std::size_t traced = 0, batch = min_rays_per_batch;
  while (traced < count && work < max_work) {
    const std::size_t end = std::min(traced + batch, count);
    batch = std::min(2 * batch, max_rays_per_batch);
    parallel_for_ranges(traced, end, rays_per_task, [&](const IndexRange<std::size_t>& range) {
      std::uint64_t of_range = 0;
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        of_range += end_at_hit(tree, geometry, ways[i]);
      work.fetch_add(of_range, std::memory_order_relaxed);
    });
    traced = end;
    if (progress && !progress(static_cast<float>(traced) / static_cast<float>(count)))
      raise(Error::cancelled, "the build was cancelled");
  }
  ways.resize(traced);
  return ways;
}

}  // namespace kerf
