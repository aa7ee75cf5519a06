#include <algorithm>
#include <chrono>
#include <utility>

#include <kerf/kerf.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "construction/construct.hpp"
#include "construction/input.hpp"
#include "construction/sbvh/parallel_build.hpp"
#include "layout/lay_out.hpp"
#include "stages.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"
#include "traversal/rays/batch.hpp"

namespace kerf {
namespace {

// What a handle of nothing shows: a constant, so that handles are made and moved without memory.
std::shared_ptr<const Bvh::Structure> nothing() noexcept {
  static const Bvh::Structure structure;
  return {std::shared_ptr<const void>(), &structure};
}

// Names the triangle of a hit by mesh and primitive.
void name_triangle(const Bvh::Structure& structure, Hit& hit) {
  hit.mesh = 0;
  if (structure.first_triangles.size() == 2) return;
  const PrimitiveId place = locate(structure, hit.primitive);
  hit.primitive = place.primitive;
  hit.mesh = place.mesh;
}

std::optional<Hit> named(const Bvh::Structure& structure, Hit hit) {
  if (!hit) return std::nullopt;
  name_triangle(structure, hit);
  return hit;
}

template <class Trace>
void for_batches(std::size_t count, Trace&& trace) {
  parallel_for_ranges(std::size_t{0}, count, rays_per_batch, [&](const auto& range) {
    for (std::size_t begin = range.begin(); begin < range.end(); begin += rays_per_batch) {
      trace(begin, std::min(rays_per_batch, range.end() - begin));
    }
  });
}

}  // namespace

Bvh::Bvh() noexcept : structure_(nothing()) {}
Bvh::Bvh(std::shared_ptr<const Structure> structure) : structure_(std::move(structure)) {}
Bvh::Bvh(Bvh&& other) noexcept : structure_(std::exchange(other.structure_, nothing())) {}
Bvh& Bvh::operator=(Bvh&& other) noexcept {
  structure_ = std::exchange(other.structure_, nothing());
  return *this;
}

std::optional<Hit> Bvh::intersect(const Ray& ray) const {
  std::optional<Hit> hit;
  const Structure& structure = *structure_;
  if (structure.wide.empty()) return hit;
  structure.kernels->closest(structure.wide, ray, hit.emplace());
  if (*hit) {
    name_triangle(structure, *hit);
  } else {
    hit.reset();
  }
  return hit;
}

bool Bvh::occluded(const Ray& ray) const {
  return !structure_->wide.empty() && structure_->kernels->any(structure_->wide, ray);
}

void Bvh::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
  if (rays.size() != hits.size()) throw Error(Error::invalid_argument, "as many hits as rays are needed");
  if (structure_->wide.empty()) {
    std::fill(hits.begin(), hits.end(), Hit{});
    return;
  }
  for_batches(rays.size(), [&](std::size_t begin, std::size_t count) {
    structure_->kernels->closest_many(structure_->wide, rays.data() + begin, count, hits.data() + begin);
    for (Hit& hit : hits.subspan(begin, count)) hit = named(*structure_, hit).value_or(Hit{});
  });
}

void Bvh::occluded(std::span<const Ray> rays, std::span<std::uint8_t> results) const {
  if (rays.size() != results.size()) {
    throw Error(Error::invalid_argument, "as many results as rays are needed");
  }
  if (structure_->wide.empty()) {
    std::fill(results.begin(), results.end(), std::uint8_t{0});
    return;
  }
  for_batches(rays.size(), [&](std::size_t begin, std::size_t count) {
    structure_->kernels->any_many(structure_->wide, rays.data() + begin, count, results.data() + begin);
  });
}

Box3f Bvh::bounds() const {
  return structure_->wide.bounds;
}

const BvhStatistics& Bvh::statistics() const {
  return structure_->statistics;
}

std::optional<Hit> intersect_counted(const Bvh& bvh, const Ray& ray, TraversalCounters& counters) {
  const Bvh::Structure& structure = bvh.structure();
  if (structure.wide.empty()) return std::nullopt;
  return named(structure, structure.kernels->closest_counted(structure.wide, ray, counters));
}

bool occluded_counted(const Bvh& bvh, const Ray& ray, TraversalCounters& counters) {
  const Bvh::Structure& structure = bvh.structure();
  return !structure.wide.empty() && structure.kernels->any_counted(structure.wide, ray, counters);
}

Bvh make_bvh(const Geometry& geometry, BinaryTree tree, unsigned threads) {
  auto structure = std::make_shared<Bvh::Structure>();
  LaidOut laid_out = on_threads(threads, [&] { return make_wide_bvh(geometry, tree); });
  structure->wide = std::move(laid_out.wide);
  structure->first_triangles.assign(geometry.first_triangles().begin(), geometry.first_triangles().end());
  structure->kernels = &choose_kernels();
  BvhStatistics& statistics = structure->statistics;
  statistics.triangles = geometry.triangle_count();
  statistics.degenerate_triangles = tree.degenerate_triangles;
  statistics.references = structure->wide.references();
  statistics.nodes = structure->wide.nodes.size();
  statistics.bytes = structure->wide.nodes.size_bytes() + structure->wide.leaves.size_bytes();
  statistics.build_peak_bytes = std::max(tree.build_peak_bytes, tree.bytes() + laid_out.peak_bytes);
  return Bvh(std::move(structure));
}

Bvh build(const TriangleMesh& mesh, const BuildOptions& options) {
  return build(std::span<const TriangleMesh>(&mesh, 1), options);
}

Bvh build(std::span<const TriangleMesh> meshes, const BuildOptions& options) {
  const PlainFloatingPoint plain;
  const auto start = std::chrono::steady_clock::now();
  Bvh bvh = report_out_of_memory([&] {
    const Geometry geometry(meshes);
    if (geometry.triangle_count() > ChildLink::max_place) {
      throw Error(Error::too_large,
                  "the meshes have 2^28 triangles or more, which is more than kerf can number");
    }
    return make_bvh(geometry, build_tree(geometry, options), options.threads);
  });
  const_cast<BvhStatistics&>(bvh.statistics()).build_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return bvh;
}

std::size_t build_memory_bound(std::size_t triangles, const BuildOptions& options) {
  check_options(options);
  // Lists of meshes and of tasks, and what allocators add to an array.
  constexpr std::size_t small_things = std::size_t{1} << 16;
  const std::size_t references = most_references(triangles, options);
  return small_things + std::max(tree_memory_bound(triangles, options),
                                 binary_tree_bytes(references) + layout_memory_bound(references));
}

}  // namespace kerf
