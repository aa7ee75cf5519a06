// A hundredth of bench/watertight_run.cpp.
#include "workbench/rays/aimed_rays.hpp"

#include <gtest/gtest.h>
#include <kerf/build.hpp>

#include "support/instrumented.hpp"

TEST(Watertight, AMillionAimedRaysNeitherLeakNorMiscount) {
  const std::vector<workbench::NamedSolid> solids = workbench::make_watertight_solids();
  for (const auto& [name, solid] : solids) {
    kerf::BuildOptions options;
    options.alpha = 0.0f;
    options.max_reference_ratio = 2.0f;
    const kerf::Bvh bvh = kerf::build(solid.mesh(), options);
    const workbench::AimedRayCounts counts =
        workbench::trace_aimed_rays(solid, bvh, test::reduced(1'000'000) / solids.size() + 1, 64);
    EXPECT_EQ(counts.leaks, 0u) << name;
    EXPECT_EQ(counts.parity_errors, 0u) << name;
  }
}
