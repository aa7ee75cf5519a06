// Aims a hundred million rays at the vertices and edges of closed surfaces and counts those that slip
// through:
//
//     build/release/bin/watertight_run [RAYS]
//
// Exit status 1 if any does, or if any number of crossings is odd that should be even.
#include <cstdlib>

#include <fmt/core.h>
#include <kerf/kerf.hpp>

#include "base/parallel.hpp"
#include "workbench/rays/aimed_rays.hpp"

int main(int argc, char** argv) {
  const std::uint64_t rays = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000'000;
  const std::vector<workbench::NamedSolid> solids = workbench::make_watertight_solids();
  workbench::AimedRayCounts total;
  fmt::print("{:34} {:>9} {:>10} {:>11} {:>6} {:>13}\n", "surface", "triangles", "references", "rays",
             "leaks", "parity errors");
  for (const workbench::NamedSolid& surface : solids) {
    const workbench::Solid& solid = surface.solid;
    kerf::BuildOptions options;
    options.alpha = 0.0f;  // spatial splits everywhere
    options.max_reference_ratio = 2.0f;
    const kerf::Bvh bvh = kerf::build(solid.mesh(), options);

    constexpr std::uint32_t parts = 64;
    std::vector<workbench::AimedRayCounts> counts(parts);
    kerf::parallel_for(parts, [&](std::uint32_t part) {
      counts[part] = workbench::trace_aimed_rays(solid, bvh, rays / solids.size() / parts + 1, part);
    });
    workbench::AimedRayCounts sum;
    for (const auto& part : counts) {
      sum.rays += part.rays;
      sum.leaks += part.leaks;
      sum.parity_errors += part.parity_errors;
    }
    fmt::print("{:34} {:9} {:10} {:11} {:6} {:13}\n", surface.name, solid.triangles.size(),
               bvh.statistics().references, sum.rays, sum.leaks, sum.parity_errors);
    std::fflush(stdout);
    total.rays += sum.rays;
    total.leaks += sum.leaks;
    total.parity_errors += sum.parity_errors;
  }
  fmt::print("{:34} {:9} {:10} {:11} {:6} {:13}\n", "all", "", "", total.rays, total.leaks,
             total.parity_errors);
  return total.leaks + total.parity_errors == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
