// Rays aimed at the vertices and edges of closed surfaces, where a tracer that is not watertight lets them
// through.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <kerf/bvh.hpp>

#include "workbench/generate/solids.hpp"

namespace workbench {

struct NamedSolid {
  std::string name;
  Solid solid;
};

/// Closed surfaces of up to 81,920 triangles: round, flat, ringed, lumpy, drawn out to slivers; some of them
/// turned, far from the origin, as small as 1e-9 and as large as 1e9.
std::vector<NamedSolid> make_watertight_solids();

struct AimedRayCounts {
  std::uint64_t rays = 0;
  std::uint64_t leaks = 0;  ///< `intersect` or `occluded` found nothing on the way through the surface
  std::uint64_t parity_errors =
      0;  ///< `all_hits` found an even number on such a way, or an odd one from outside
};

/// Traces `count` rays through random vertices and points of edges, and counts what went wrong. In turn: from
/// a point inside without end; from outside without end; from outside to a point inside. Inside and outside
/// are told by `contains`; points inside are at least 1e-5 of the surface's extent away from it. The
/// same rays for the same `seed`.
AimedRayCounts trace_aimed_rays(const Solid& solid, const kerf::Bvh& bvh, std::uint64_t count,
                                std::uint32_t seed);

}  // namespace workbench
