// Rays aimed at the vertices and edges of closed surfaces, where they slip through a tracer that is not
// watertight.
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

/// Closed surfaces of up to 81,920 triangles: spheres, boxes, tori, lumpy spheres and slivers. Some are
/// turned, some are far from the origin, and sizes range from 1e-9 to 1e9.
std::vector<NamedSolid> make_watertight_solids();

struct AimedRayCounts {
  std::uint64_t rays = 0;
  std::uint64_t leaks = 0;  ///< `intersect` or `occluded` found nothing where the ray crosses the surface

  /// `all_hits` found an even number of crossings between inside and outside, or an odd one between outside
  /// and outside.
  std::uint64_t parity_errors = 0;
};

/// Traces `count` rays through random vertices and points of edges, and counts the errors. Three kinds of
/// rays follow each other in rotation: from a point inside without end, from outside without end, and from
/// outside to a point inside. `contains` decides what is inside. Points inside are at least 1e-5 of the
/// surface's extent away from it. The rays are the same for the same `seed`.
AimedRayCounts trace_aimed_rays(const Solid& solid, const kerf::Bvh& bvh, std::uint64_t count,
                                std::uint32_t seed);

}  // namespace workbench
