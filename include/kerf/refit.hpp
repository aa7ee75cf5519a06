// Meshes that bend: a hierarchy follows corners that have moved.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <concepts>
#include <span>

#include <kerf/build.hpp>
#include <kerf/bvh.hpp>
#include <kerf/export.hpp>
#include <kerf/mesh.hpp>

namespace kerf {

/// What a refit has made of a hierarchy.
struct RefitReport {
  /// What a random ray is expected to cost (the surface area heuristic), over what it cost when the hierarchy
  /// was built or loaded. Where this has grown to more than 1.2, a new build is worth a thought.
  double cost_ratio = 1.0;
  /// Whether the hierarchy was built anew, because a triangle that it does not hold has an area now.
  bool rebuilt = false;
};

/// Moves the triangles of `bvh` to where `meshes` have them now, in a fraction of the time of a build. There
/// must be as many meshes as were built, each with as many triangles; a triangle may have other corners, but
/// is traced slower then. Every answer is that of a new build of `meshes`, except that masks stay as they
/// were.
///
/// Where spatial splits have put a triangle into several leaves, each moves its part of the triangle along.
/// The first refit of a hierarchy finds these parts, and keeps some 25 bytes for each, and a bit for each
/// reference, from then on. Triangles that lose their area are left out as a build leaves them out, and come
/// back with it. If one gets an area that the hierarchy does not hold at all, `options` are those of a new
/// build; else only `threads` and `non_finite` count. What the report says does not depend on the number of
/// threads.
///
/// Works in place if no other handle shares the hierarchy; else `bvh` gets a copy, and the others stay as
/// they are. No other call of this handle may run meanwhile. Throws as `build` does, and
/// `Error::invalid_argument` if the numbers of meshes or triangles are others. `bvh` is then what it was,
/// unless memory ran out in the middle: then it is a hierarchy of nothing.
KERF_API RefitReport refit(Bvh& bvh, std::span<const TriangleMesh> meshes, const BuildOptions& options = {});

/// The same for a hierarchy of one mesh.
template <std::same_as<TriangleMesh> Mesh = TriangleMesh>
RefitReport refit(Bvh& bvh, const Mesh& mesh, const BuildOptions& options = {}) {
  return refit(bvh, std::span<const TriangleMesh>(&mesh, 1), options);
}

}  // namespace kerf

#endif  // KERF_HAS_CPP20
