// Memory runs out at every allocation, and a build is cancelled at every call of its progress function.
#include <vector>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "resources/counted_memory.hpp"
#include "support/build_options.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using counted_memory::FailingAllocation;
using counted_memory::live_bytes;

// Lets the first allocation of `work` fail, then the second, and so on until `work` succeeds. Each time it
// must throw `Error::out_of_memory` and leave no memory behind. Returns the number of allocations.
template <class Work>
std::int64_t fail_each_allocation(const Work& work) {
  work();  // makes what is made once and kept, such as the threads
  for (std::int64_t n = 1;; ++n) {
    const std::int64_t before = live_bytes();
    bool failed = false;
    {
      const FailingAllocation failing(n);
      try {
        work();
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), Error::out_of_memory) << error.what();
        failed = true;
      }
      EXPECT_EQ(failed, failing.happened()) << "allocation " << n;
    }
    EXPECT_EQ(live_bytes(), before) << "allocation " << n;
    if (!failed || testing::Test::HasFailure()) return n - 1;
  }
}

// A box with a fine sphere in it makes object splits, spatial splits and leaves of all sizes.
struct Scene {
  workbench::Solid sphere = workbench::make_sphere(3), box = workbench::make_box({-2, -2, -2}, {2, 2, 2}, 1);
  std::vector<TriangleMesh> meshes{sphere.mesh(), box.mesh()};
};

TEST(Resources, ABuildSurvivesTheFailureOfAnyAllocation) {
  const Scene scene;
  for (const BuilderInfo& info : builders()) {
    BuildOptions options = spatial_splits_everywhere();
    options.builder = info.builder;
    options.threads = 1;
    EXPECT_GT(fail_each_allocation([&] { (void)build(scene.meshes, options); }), 3);
  }
}

TEST(Resources, ABuildOnTwoThreadsSurvivesTheFailureOfAnyAllocation) {
  const workbench::Solid sphere = workbench::make_sphere(5);
  BuildOptions options;
  options.threads = 2;
  EXPECT_GT(fail_each_allocation([&] { (void)build(sphere.mesh(), options); }), 3);
}

TEST(Resources, FilesSurviveTheFailureOfAnyAllocation) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory / "scene.kerf";
  const Bvh bvh = build(Scene().meshes);
  EXPECT_GT(fail_each_allocation([&] { bvh.save(path); }), 0);
  EXPECT_GT(fail_each_allocation([&] { (void)Bvh::load(path); }), 2);
  EXPECT_GT(fail_each_allocation([&] { (void)Bvh::map(path); }), 2);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1) << "left behind";
}

TEST(Resources, QueriesSurviveTheFailureOfAnyAllocation) {
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<std::uint32_t> indices;
  for (int i = 0; i < 3 * 5000; ++i) indices.push_back(static_cast<std::uint32_t>(i % 3));
  const Bvh bvh = build({.vertices = vertices, .triangles = indices});
  const Ray ray{.origin = {0.2f, 0.2f, 1}, .direction = {0, 0, -1}};
  EXPECT_GT(fail_each_allocation([&] { (void)bvh.all_hits(ray, std::span<Hit>()); }), 0);
  EXPECT_GT(fail_each_allocation([&] { (void)bvh.triangles_in(bvh.bounds()); }), 0);
  EXPECT_GT(fail_each_allocation([&] { (void)bvh.within({0, 0, 0}, 1.0f); }), 0);
  fail_each_allocation([&] { (void)bvh.closest_point({0, 0, 2}); });
  fail_each_allocation([&] { (void)bvh.contains({0.1f, 0.1f, 0.0f}); });
}

TEST(Resources, ACancelledBuildLeavesNothingBehind) {
  const workbench::Solid sphere = workbench::make_sphere(4);
  (void)build(sphere.mesh());
  for (int allowed = 0;; ++allowed) {
    const std::int64_t before = live_bytes();
    bool cancelled = false;
    {
      BuildOptions options;
      float last = 0.0f;
      int calls = 0;
      options.progress = [&](float fraction) {
        EXPECT_GE(fraction, last);
        EXPECT_LE(fraction, 1.0f);
        last = fraction;
        return ++calls <= allowed;
      };
      try {
        (void)build(sphere.mesh(), options);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), Error::cancelled);
        cancelled = true;
      }
    }
    EXPECT_EQ(live_bytes(), before);
    if (!cancelled) break;
    ASSERT_LT(allowed, 100000);
  }
}

TEST(Resources, TooManyTrianglesAreRefusedBeforeMemoryIsTaken) {
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::uint32_t triangle[] = {0, 1, 2};
  for (const std::size_t count : {std::size_t{1} << 28, std::size_t{1} << 31, std::size_t{1} << 40}) {
    const TripleView<std::uint32_t> triangles(triangle, count, 0);  // the same one over and over
    counted_memory::restart_peak();
    const std::int64_t before = live_bytes();
    try {
      (void)build({.vertices = vertices, .triangles = triangles});
      FAIL() << count;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::too_large);
    }
    EXPECT_LT(counted_memory::peak_bytes() - before, 4096);
  }
}

// Each mesh has fewer triangles than the limit, but both together have more.
TEST(Resources, TooManyTrianglesInSeveralMeshesAreRefused) {
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::uint32_t triangle[] = {0, 1, 2};
  const TriangleMesh half{.vertices = vertices,
                          .triangles = TripleView<std::uint32_t>(triangle, std::size_t{1} << 27, 0)};
  EXPECT_THROW((void)build(std::vector<TriangleMesh>(2, half)), Error);
}

}  // namespace
}  // namespace kerf
