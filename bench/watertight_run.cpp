// Aims a hundred million rays at the vertices and edges of closed surfaces and counts those that slip
// through:
//
//     build/release/bin/watertight_run [RAYS]
//
// The exit status is 1 if any ray slips through, or if the parity of any number of crossings is wrong.
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

    constexpr std::uint32_t seeds = 64;
    std::vector<workbench::AimedRayCounts> counts(seeds);
    kerf::parallel_for(seeds, [&](std::uint32_t seed) {
      counts[seed] = workbench::trace_aimed_rays(solid, bvh, rays / solids.size() / seeds + 1, seed);
    });
    workbench::AimedRayCounts sum;
    for (const auto& count : counts) {
      sum.rays += count.rays;
      sum.leaks += count.leaks;
      sum.parity_errors += count.parity_errors;
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
