// From meshes to a hierarchy that can be traced.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include <kerf/bvh.hpp>
#include <kerf/export.hpp>
#include <kerf/mesh.hpp>
#include <kerf/ray.hpp>

namespace kerf {

/// Which hierarchy to build. All use the same surface-area heuristic and the same rule for leaves.
enum class Builder {
  sbvh,  ///< object and spatial splits (Stich, Friedrich & Dietrich 2009): the one to use
  bvh,   ///< object splits only
  esc,   ///< early split clipping (Ernst & Greiner 2007), for comparison
  evh,   ///< edge volume heuristic (Dammertz & Keller 2008), for comparison
};

/// How much time a build spends on the tree, beside what its builder does.
enum class Quality {
  fast,  ///< none
  high,  ///< subtrees with large boxes are moved to better places: a fifth to four fifths more time
  best,  ///< all subtrees, until no move pays: five to fifty times as long
};

/// What becomes of triangles with a vertex that is not a number, infinite, or 2^126 and more.
enum class NonFinite {
  refuse,  ///< the build throws `Error::non_finite_vertex`, which names the first
  skip,    ///< they are left out and counted; the numbers of the others stay what they are
};

/// How to build. The defaults suit most uses.
struct BuildOptions {
  Builder builder = Builder::sbvh;  ///< which hierarchy

  /// How good a tree to make. `high` and `best` move subtrees to where they cost less (Meister & Bittner
  /// 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization"), parts of divided triangles
  /// included.
  Quality quality = Quality::fast;

  /// `high` and `best` end after this many seconds with what they have. How far they come then depends on the
  /// machine: only without a limit is the tree the same everywhere. Range: [0, infinity].
  double max_refinement_seconds = std::numeric_limits<double>::infinity();

  /// Rays such as will be traced, closest hits and occlusion alike, in the coordinates of the mesh: what they
  /// visit decides which nodes of the tree become one node of the layout, and with `high` and `best` where
  /// subtrees are moved, in place of the areas of boxes (Bittner & Havran 2009, "RDH: Ray Distribution
  /// Heuristics for Construction of Spatial Hierarchies"). A few thousand say most; of more than 2^18 so many
  /// are taken, evenly spread. Answers do not depend on them. Read by the build alone.
  std::span<const Ray> sample_rays = {};

  /// A spatial split is tried where the children of the best object split overlap by more than this fraction
  /// of the root's surface area (Stich et al. 2009, section 4.5). It is tried neither in nodes of fewer than
  /// 96 references nor where the overlap is under a twentieth of the node's own area: nearly none is found
  /// there (docs/decisions/0011, 0012). 0 tries everywhere without exception, 1 nowhere. Range: [0, 1].
  float alpha = 1e-5f;

  /// At most this many references per triangle. The memory for them is taken before the build begins.
  /// 1 leaves no room for spatial splits. Range: [1, 16].
  float max_reference_ratio = 1.5f;

  /// At most this many references in a leaf. Range: [1, 8].
  std::uint32_t max_leaf_size = 8;

  /// Threads to use; 0 uses all, or inside a caller's oneTBB task arena those of the arena. The tree is the
  /// same for any number.
  unsigned threads = 0;

  /// What becomes of triangles with vertices that are not finite.
  NonFinite non_finite = NonFinite::refuse;

  /// For `esc` and `evh` only: the maximum number of references that splitting before the build makes. The
  /// threshold that comes nearest without exceeding it is found by bisection. 0 stands for
  /// `max_reference_ratio` per triangle.
  std::size_t presplit_references = 0;

  /// Called now and then, from any thread but never from two at once, with a fraction in [0, 1] that never
  /// falls. Returning false cancels the build, which then throws `Error::cancelled`.
  std::function<bool(float)> progress = {};
};

/// Builds the hierarchy of one mesh. Degenerate triangles, which have no area, are left out, and so are those
/// that `BuildOptions::non_finite` says to skip; both are counted. Throws `Error`: `invalid_argument`,
/// `non_finite_vertex`, `index_out_of_range`, `too_large`, `out_of_memory`, `cancelled`. The mesh may be
/// freed as soon as this returns.
template <std::same_as<TriangleMesh> Mesh = TriangleMesh>  // so that doubles in braces are a `DoubleMesh`
Bvh build(const Mesh& mesh, const BuildOptions& options = {});

/// Builds one hierarchy over several meshes. Hits name a mesh by its place in `meshes`.
KERF_API Bvh build(std::span<const TriangleMesh> meshes, const BuildOptions& options = {});

/// Builds the hierarchy of a mesh in double precision. It lies in a local frame: vertices are rounded to
/// floats once, as distances from `Bvh::origin`. `Bvh::to_local` and `from_local` take rays and points there
/// and back. Where floats hold every coordinate, or none is larger than the mesh itself, the origin is 0.
/// Triangles that lose their area by the rounding are counted in `BvhStatistics::degenerate_by_rounding`.
/// Beside what other builds hold, this one holds 12 bytes for each vertex and, of 64-bit indices, for each
/// triangle, and 32 for each sample ray.
KERF_API Bvh build(const DoubleMesh& mesh, const BuildOptions& options = {});

/// Builds one hierarchy, with one origin, over several meshes in double precision.
KERF_API Bvh build(std::span<const DoubleMesh> meshes, const BuildOptions& options = {});

/// An upper bound of the bytes that a build by `sbvh` or `bvh` of so many triangles holds at once, whatever
/// the triangles are. In practice it holds less than half, see `BvhStatistics::build_peak_bytes`. Throws
/// `Error::invalid_argument` as `build` does.
KERF_API std::size_t build_memory_bound(std::size_t triangles, const BuildOptions& options = {});

template <std::same_as<TriangleMesh> Mesh>
Bvh build(const Mesh& mesh, const BuildOptions& options) {
  return build(std::span<const TriangleMesh>(&mesh, 1), options);
}

}  // namespace kerf

#endif  // KERF_HAS_CPP20
