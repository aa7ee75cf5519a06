// A hierarchy follows its triangles.
#include "layout/refit.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include <kerf/refit.hpp>

#include "base/aligned_array.hpp"
#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "construction/input.hpp"
#include "construction/options.hpp"
#include "math/coordinate_limit.hpp"
#include "math/triangle.hpp"
#include "simd/dispatch.hpp"
#include "structure.hpp"
#include "tree/geometry.hpp"

namespace kerf {
namespace {

void check_counts(const Structure& structure, const Geometry& geometry) {
  const auto& was = structure.first_triangles;
  const auto is = geometry.first_triangles();
  const std::size_t meshes = was.empty() ? 0 : was.size() - 1;
  if (is.size() - 1 != meshes) {
    raise(Error::invalid_argument, "refit was given %zu meshes, but the hierarchy was built of %zu",
          is.size() - 1, meshes);
  }
  for (std::size_t m = 0; m < meshes; ++m) {
    if (is[m + 1] - is[m] != was[m + 1] - was[m]) {
      raise(Error::invalid_argument, "mesh %zu has %u triangles, but %u when the hierarchy was built", m,
            is[m + 1] - is[m], was[m + 1] - was[m]);
    }
  }
}

// Calls `check(i)` for 0 <= i < count until it is false, and returns whether it never was.
template <class Check>
bool all_of(std::size_t count, const Check& check) {
  std::atomic<bool> all = true;
  parallel_for_ranges(std::size_t{0}, count, 1 << 14, [&](const auto& range) {
    bool good = true;
    for (std::size_t i = range.begin(); i < range.end(); ++i) good &= check(i);
    if (!good) all = false;
  });
  return all;
}

bool all_indices_in_range(const TriangleMesh& mesh) {
  return all_of(mesh.triangles.size(), [&](std::size_t i) {
    const auto [a, b, c] = mesh.triangles[i].values;
    return std::max({a, b, c}) < mesh.vertices.size();
  });
}

bool all_vertices_in_range(const TriangleMesh& mesh) {
  return all_of(mesh.vertices.size(), [&](std::size_t i) {
    const auto [x, y, z] = mesh.vertices[i].values;
    return is_in_range(Vec3f{x, y, z});
  });
}

// Throws for what a build refuses.
void check_meshes(const Geometry& geometry, NonFinite non_finite) {
  const auto meshes = geometry.meshes();
  const bool refuse = non_finite == NonFinite::refuse;
  if (!std::all_of(meshes.begin(), meshes.end(), all_indices_in_range) ||
      (refuse && !std::all_of(meshes.begin(), meshes.end(), all_vertices_in_range))) {
    for (std::uint32_t id = 0; id < geometry.triangle_count(); ++id) check_triangle(geometry, id);
  }
}

bool has_area(const Triangle& triangle) {
  return is_in_range(triangle) && !is_degenerate(triangle);
}

// Whether this is the only handle. What other threads did through theirs has happened then.
bool is_only_handle(const std::shared_ptr<const Structure>& structure) {
  if (structure.use_count() != 1) return false;
  const std::shared_ptr<const Structure> other = structure;  // to let go of it is to wait for what was done
  return true;
}

bool is_in_place(const std::shared_ptr<const Structure>& structure) {
  const WideBvh& wide = structure->wide;
  return is_only_handle(structure) && structure->writable && wide.node_memory.use_count() == 1 &&
         wide.leaf_memory.use_count() == 1;
}

WideBvh copy_of(const WideBvh& wide) {
  const AlignedArray<std::byte> nodes(wide.node_bytes());
  const AlignedArray<std::uint32_t> leaves(wide.leaves.size());
  std::memcpy(nodes.data(), wide.node_data, nodes.size());
  std::memcpy(leaves.data(), wide.leaves.data(), wide.leaves.size_bytes());
  WideBvh copy = wide;
  copy.node_data = nodes.data();
  copy.leaves = {leaves.data(), leaves.size()};
  copy.node_memory = nodes.owner();
  copy.leaf_memory = leaves.owner();
  return copy;
}

// How many triangles are left out now, and which of them for which reason.
void count_left_out(const Geometry& geometry, Structure& structure) {
  std::vector<std::uint32_t> ids = structure.refit_basis->left_out;
  for (const StandIn& stand_in : structure.stand_ins) ids.push_back(stand_in.id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  const auto finite = std::count_if(ids.begin(), ids.end(),
                                    [&](std::uint32_t id) { return is_in_range(geometry.triangle(id)); });
  structure.statistics.degenerate_triangles = static_cast<std::size_t>(finite);
  structure.statistics.non_finite_triangles = ids.size() - static_cast<std::size_t>(finite);
}

RefitReport build_anew(Bvh& bvh, std::span<const TriangleMesh> meshes, const BuildOptions& options) {
  const Structure& before = Structure::of(bvh);
  Bvh built = build(meshes, options);
  auto structure = std::make_shared<Structure>(Structure::of(built));
  structure->masks = before.masks;
  structure->origin = before.origin;
  bvh = Structure::share(std::move(structure));
  return {.cost_ratio = 1.0, .rebuilt = true};
}

RefitReport refit(Bvh& bvh, const Geometry& geometry, const BuildOptions& options) {
  std::shared_ptr<const Structure>& shared = Structure::pointer_of(bvh);
  check_meshes(geometry, options.non_finite);
  if (shared->wide.empty() || (shared->refit_basis == nullptr && !leaves_are_apart(shared->wide)))
    return build_anew(bvh, geometry.meshes(), options);

  std::shared_ptr<const RefitBasis> basis = shared->refit_basis;
  if (basis == nullptr)
    basis = std::make_shared<RefitBasis>(make_refit_basis(shared->wide, geometry.triangle_count()));
  if (std::any_of(basis->left_out.begin(), basis->left_out.end(),
                  [&](std::uint32_t id) { return has_area(geometry.triangle(id)); }))
    return build_anew(bvh, geometry.meshes(), options);

  const bool in_place = is_in_place(shared);
  std::shared_ptr<Structure> structure =
      in_place ? std::const_pointer_cast<Structure>(shared) : std::make_shared<Structure>(*shared);
  if (!in_place) {
    structure->wide = copy_of(shared->wide);
    structure->writable = true;
  }
  structure->refit_basis = std::move(basis);
  const bool had_stand_ins = !structure->stand_ins.empty();
  try {
    if (!kerf::refit(*structure->refit_basis, geometry, choose_target(), structure->wide,
                     structure->stand_ins))
      return build_anew(bvh, geometry.meshes(), options);
    count_left_out(geometry, *structure);
    // What is kept of where triangles stand is right no more.
    if (in_place && (had_stand_ins || !structure->stand_ins.empty()))
      structure = std::make_shared<Structure>(*structure);
  } catch (...) {
    if (in_place) bvh = Bvh();
    throw;
  }
  shared = structure;
  return {.cost_ratio = traversal_cost(structure->wide) / structure->refit_basis->cost, .rebuilt = false};
}

// Below this a task costs as much as it does.
constexpr std::size_t max_triangles_of_one_task = 2048;

}  // namespace

RefitReport refit(Bvh& bvh, std::span<const TriangleMesh> meshes, const BuildOptions& options) {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    check_options(options);
    const Geometry geometry(meshes);
    check_counts(Structure::of(bvh), geometry);
    const auto work = [&] { return refit(bvh, geometry, options); };
    return geometry.triangle_count() <= max_triangles_of_one_task ? on_this_thread(work)
                                                                  : on_threads(options.threads, work);
  });
}

}  // namespace kerf
