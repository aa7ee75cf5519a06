// The road from end to end: meshes become a tree, and the tree becomes the structure that is traced.
#include "build.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <utility>
#include <vector>

#include <kerf/build.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "base/seconds_since.hpp"
#include "construction/builders.hpp"
#include "construction/construct.hpp"
#include "construction/options.hpp"
#include "construction/sbvh/parallel_build.hpp"
#include "layout/lay_out.hpp"
#include "local_frame.hpp"
#include "refinement/refine.hpp"
#include "refinement/sample_ways.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

// Below this every stage of a build is one task, and the scheduler would only cost its entry and exit.
constexpr std::size_t max_triangles_of_one_task = 2048;

bool is_one_task(const Geometry& geometry, const BuildOptions& options) {
  return geometry.triangle_count() <= max_triangles_of_one_task && options.presplit_references == 0;
}

std::shared_ptr<Structure> build_structure(std::span<const TriangleMesh> meshes,
                                           const BuildOptions& options) {
  const Geometry geometry(meshes);
  const auto from_end_to_end = [&] {
    return lay_out_tree(geometry, make_tree(geometry, options), options.threads);
  };
  return is_one_task(geometry, options) ? on_this_thread(from_end_to_end) : isolated(from_end_to_end);
}

// Of the time of a build that refines, the part that its builder takes, about.
float share_of_construction(Quality quality) {
  return quality == Quality::best ? 0.1f : 0.6f;
}

// Of what is left then, the part of tracing sample rays.
constexpr float share_of_tracing = 0.2f;

// Rays in floats are good enough to tell what is visited.
std::vector<Ray> in_frame(std::span<const Ray> rays, const Vec3d& frame) {
  std::vector<Ray> local = pick_samples(rays);
  for (Ray& ray : local) {
    ray.origin = {static_cast<float>(ray.origin.x - frame.x), static_cast<float>(ray.origin.y - frame.y),
                  static_cast<float>(ray.origin.z - frame.z)};
  }
  return local;
}

std::vector<std::uint32_t> masks_of(std::span<const TriangleMesh> meshes) {
  std::vector<std::uint32_t> masks;
  if (std::all_of(meshes.begin(), meshes.end(), [](const TriangleMesh& m) { return m.mask == Mask(); }))
    return masks;
  for (const TriangleMesh& mesh : meshes) masks.push_back(mesh.mask.bits);
  return masks;
}

}  // namespace

BinaryTree make_tree(const Geometry& geometry, const BuildOptions& options) {
  const bool has_rays = !options.sample_rays.empty();
  if (options.quality == Quality::fast && !has_rays) return construct(geometry, options);
  // Every stage has a part of the progress.
  const auto part = [&](float begin, float end) -> std::function<bool(float)> {
    if (!options.progress) return {};
    return [&options, begin, end](float done) { return options.progress(begin + (end - begin) * done); };
  };
  const float constructed = share_of_construction(options.quality);
  const float traced = has_rays ? constructed + share_of_tracing * (1.0f - constructed) : constructed;
  BuildOptions building = options;
  building.progress = part(0.0f, constructed);
  BinaryTree tree = construct(geometry, building);
  std::vector<Ray> ways;
  if (has_rays) {
    ways = on_threads(options.threads, [&] {
      return trace_to_hits(tree, geometry, options.sample_rays, part(constructed, traced));
    });
  }
  refine(tree, ways, options, part(traced, 1.0f));
  return tree;
}

std::shared_ptr<Structure> lay_out_tree(const Geometry& geometry, const BinaryTree& tree, unsigned threads) {
  LaidOut laid_out =
      on_threads(threads, [&] { return make_wide_bvh(geometry, tree, choose_kernels().node_width); });
  const auto first_triangles = geometry.first_triangles();
  auto structure = make_structure(std::move(laid_out.wide), {first_triangles.begin(), first_triangles.end()},
                                  tree.degenerate_triangles);
  structure->statistics.non_finite_triangles = tree.non_finite_triangles;
  structure->writable = true;
  structure->masks = masks_of(geometry.meshes());
  structure->statistics.build_peak_bytes =
      std::max(tree.build_peak_bytes, tree.bytes() + laid_out.peak_bytes);
  return structure;
}

Bvh build(std::span<const TriangleMesh> meshes, const BuildOptions& options) {
  const PlainFloatingPoint plain;
  const auto start = std::chrono::steady_clock::now();
  return report_out_of_memory([&] {
    const auto structure = build_structure(meshes, options);
    structure->statistics.build_seconds = seconds_since(start);
    return Structure::share(structure);
  });
}

Bvh build(std::span<const DoubleMesh> meshes, const BuildOptions& options) {
  const PlainFloatingPoint plain;
  const auto start = std::chrono::steady_clock::now();
  return report_out_of_memory([&] {
    return on_threads(options.threads, [&] {
      check_options(options);
      const LocalFrame frame(meshes, options.non_finite);
      BuildOptions local = options;
      const std::vector<Ray> rays = in_frame(options.sample_rays, frame.origin());
      local.sample_rays = rays;
      const auto structure = build_structure(frame.meshes(), local);
      structure->origin = frame.origin();
      BvhStatistics& statistics = structure->statistics;
      if (statistics.degenerate_triangles != 0)
        statistics.degenerate_by_rounding = frame.degenerate_by_rounding();
      statistics.build_peak_bytes += frame.bytes() + rays.size() * sizeof(Ray);
      statistics.build_seconds = seconds_since(start);
      return Structure::share(structure);
    });
  });
}

Bvh build(const DoubleMesh& mesh, const BuildOptions& options) {
  return build(std::span<const DoubleMesh>(&mesh, 1), options);
}

std::size_t build_memory_bound(std::size_t triangles, const BuildOptions& options) {
  check_options(options);
  // Lists of meshes and of tasks, and what allocators add to an array.
  constexpr std::size_t small_things = std::size_t{1} << 16;
  const std::size_t references = max_references(triangles, options);
  const std::size_t ways = std::min(options.sample_rays.size(), max_sample_rays);
  const std::size_t visits = options.sample_rays.empty() ? 0 : 2 * references * sizeof(float);
  return small_things + std::max({find_builder(options.builder)->memory_bound(triangles, options),
                                  refinement_memory_bound(references, ways, options),
                                  binary_tree_bytes(references) + visits + layout_memory_bound(references)});
}

}  // namespace kerf
