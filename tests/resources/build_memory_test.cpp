// The peak memory of a build as counted from outside, beside what the build reports and what it promised.
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "resources/counted_memory.hpp"
#include "support/random_triangles.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/rays/rays.hpp"

namespace kerf {
namespace {

// The bound of what is allocated beside the arrays: lists of meshes and of tasks, and what allocators add.
constexpr std::size_t small_things = std::size_t{1} << 16;

struct Peak {
  std::size_t counted, reported;
};

Peak peak_of(const TriangleMesh& mesh, const BuildOptions& options) {
  (void)build(mesh, options);  // makes what is made once and kept, such as the threads
  const std::int64_t before = counted_memory::live_bytes();
  counted_memory::restart_peak();
  const Bvh bvh = build(mesh, options);
  return {static_cast<std::size_t>(counted_memory::peak_bytes() - before), bvh.statistics().build_peak_bytes};
}

void expect_honest(const TriangleMesh& mesh, const BuildOptions& options) {
  const Peak peak = peak_of(mesh, options);
  EXPECT_LE(peak.counted, peak.reported + small_things);
  EXPECT_GE(peak.counted, peak.reported - peak.reported / 16) << "more is reported than was held";
  EXPECT_LE(peak.reported + small_things, build_memory_bound(mesh.triangles.size(), options));
}

void expect_honest_at_all_ratios(const TriangleMesh& mesh) {
  for (const float ratio : {1.0f, 1.1f, 1.5f, 3.0f}) {
    for (const unsigned threads : {1u, 2u}) {
      for (const std::uint32_t leaf : {1u, 8u}) {
        SCOPED_TRACE(testing::Message() << "ratio " << ratio << ", threads " << threads << ", leaf " << leaf);
        expect_honest(mesh, {.max_reference_ratio = ratio, .max_leaf_size = leaf, .threads = threads});
      }
    }
  }
}

TEST(BuildMemory, PeakOfAnArchitecturalSceneIsAsReported) {
  const workbench::Scene atrium = workbench::load_scene("atrium:detail=0.1,rotate=30");
  expect_honest_at_all_ratios(atrium.mesh());
}

TEST(BuildMemory, PeakOfAFineSurfaceIsAsReported) {
  expect_honest_at_all_ratios(workbench::make_sphere(6).mesh());
}

TEST(BuildMemory, PeakOfARefinementIsAsReported) {
  const workbench::Scene atrium = workbench::load_scene("atrium:detail=0.1,rotate=30");
  for (const Quality quality : {Quality::high, Quality::best}) {
    for (const std::uint32_t leaf : {1u, 8u}) {
      SCOPED_TRACE(testing::Message() << "quality " << static_cast<int>(quality) << ", leaf " << leaf);
      expect_honest(atrium.mesh(), {.quality = quality, .max_leaf_size = leaf});
    }
  }
}

TEST(BuildMemory, PeakOfABuildForSampleRaysIsAsReported) {
  const workbench::Scene atrium = workbench::load_scene("atrium:detail=0.03,rotate=30");
  const Bvh bvh = build(atrium.mesh());
  const workbench::RaySet set =
      workbench::make_rays(atrium, bvh, workbench::RayType::primary, {.width = 128, .height = 96});
  for (const Quality quality : {Quality::fast, Quality::high}) {
    for (const std::uint32_t leaf : {1u, 8u}) {
      SCOPED_TRACE(testing::Message() << "quality " << static_cast<int>(quality) << ", leaf " << leaf);
      expect_honest(atrium.mesh(), {.quality = quality, .sample_rays = set.rays, .max_leaf_size = leaf});
    }
  }
}

// Every leaf holds one reference, most triangles are divided, and the arena has little room.
TEST(BuildMemory, PeakOfSticksIsAsReported) {
  expect_honest_at_all_ratios(kerf_tests::random_triangles(20000, 0.5f, 0.001f).mesh());
}

// The triangles cannot be distinguished, so that every cost is the same.
TEST(BuildMemory, PeakOfIdenticalTrianglesIsAsReported) {
  kerf_tests::Mesh mesh = kerf_tests::random_triangles(1, 0.5f, 0.5f);
  mesh.triangles.resize(30000, mesh.triangles.front());
  expect_honest_at_all_ratios(mesh.mesh());
}

// Boxes whose areas are zero or infinite in floats, where all costs tie.
TEST(BuildMemory, PeakAtTheEndsOfTheRangeIsAsReported) {
  for (const float scale : {0x1p-80f, 0x1p125f}) {
    kerf_tests::Mesh mesh = kerf_tests::random_triangles(20000, 0.05f, 0.05f);
    for (Vec3f& vertex : mesh.vertices) vertex = {vertex.x * scale, vertex.y * scale, vertex.z * scale};
    expect_honest_at_all_ratios(mesh.mesh());
  }
}

TEST(BuildMemory, ABuildWithSpatialSplitsEverywhereKeepsItsPromise) {
  const kerf_tests::Mesh mesh = kerf_tests::random_triangles(20000, 0.3f, 0.3f);
  for (const float ratio : {1.1f, 3.0f, 16.0f})
    expect_honest(mesh.mesh(), {.alpha = 0.0f, .max_reference_ratio = ratio, .threads = 1});
}

}  // namespace
}  // namespace kerf
