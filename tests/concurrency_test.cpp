// Builds and queries from many threads at the same time, for ThreadSanitizer and for the answers.
#include <atomic>
#include <random>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include "base/parallel.hpp"
#include "support/adversarial.hpp"
#include "support/instrumented.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

// The answers to all kinds of queries, as one thread asks them.
std::string answers(const Bvh& bvh, unsigned seed) {
  std::mt19937 random(seed);
  std::string text;
  const auto note = [&](auto value) { text += std::to_string(value) + ' '; };
  for (int i = 0; i < 50; ++i) {
    const Ray ray{.origin = adversarial::uniform_point(random, 2.0f),
                  .direction = adversarial::uniform_point(random, 1.0f)};
    const auto hit = bvh.intersect(ray);
    note(hit ? hit->t : -1.0f);
    note(bvh.occluded(ray));
    note(bvh.all_hits(ray, std::span<Hit>()));
    note(bvh.signed_distance(ray.origin));
    note(bvh.within(ray.origin, 0.5f).size());
    note(bvh.triangles_in({ray.origin, ray.origin + Vec3f{1, 1, 1}}).size());
  }
  std::vector<Ray> rays(64, Ray{.origin = {0, 0, 0}, .direction = {1, 0.5f, 0.25f}});
  std::vector<Hit> hits(rays.size());
  bvh.intersect(rays, hits);
  for (const Hit& hit : hits) note(hit.t);
  return text;
}

TEST(Concurrency, OneHierarchyAnswersManyThreadsAsOne) {
  const Bvh bvh = build(workbench::make_sphere(4).mesh());
  constexpr unsigned threads = 4;
  std::vector<std::string> found(threads);
  {
    std::vector<std::jthread> running;
    for (unsigned i = 0; i < threads; ++i) running.emplace_back([&, i] { found[i] = answers(bvh, i); });
  }
  for (unsigned i = 0; i < threads; ++i) EXPECT_EQ(found[i], answers(bvh, i));
}

TEST(Concurrency, BuildsSavesAndLoadsRunBesideEachOther) {
  const workbench::Solid sphere = workbench::make_sphere(4), torus = workbench::make_torus(48, 24);
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory / "scene.kerf";
  const std::string expected[] = {answers(build(sphere.mesh()), 1), answers(build(torus.mesh()), 1)};
  constexpr unsigned threads = 4;
  std::vector<std::string> found(threads);
  {
    std::vector<std::jthread> running;
    for (unsigned i = 0; i < threads; ++i) {
      running.emplace_back([&, i] {
        BuildOptions options;
        options.threads = i;
        const Bvh bvh = build((i % 2 ? torus : sphere).mesh(), options);
        bvh.save(path);                     // all to the same name: one of them stands there in the end,
        (void)answers(Bvh::load(path), i);  // whole at any time
        found[i] = answers(bvh, 1);
      });
    }
  }
  for (unsigned i = 0; i < threads; ++i) EXPECT_EQ(found[i], expected[i % 2]);
}

#ifndef KERF_STANDARD_THREADS  // ThreadSanitizer cannot see how oneTBB's tasks are ordered
// A caller's loop over tiles, each with something of its thread's own. If a call waited for its tasks by
// running the caller's, a tile would begin in the middle of another, on the same thread.
template <class Call>
int tiles_begun_within_another(int tiles, const Call& call) {
  static thread_local bool within = false;
  std::atomic<int> begun_within = 0;
  // More threads than cores: some wait for what others have taken.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
  tbb::task_arena(8).execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, tiles, 1),
        [&](const tbb::blocked_range<int>& range) {
          for (int i = range.begin(); i != range.end(); ++i) {
            if (within) ++begun_within;
            within = true;
            call();
            within = false;
          }
        },
        tbb::simple_partitioner());
  });
  return begun_within;
}

TEST(Concurrency, CallsRunNoTaskOfTheCallerWhileTheyWait) {
  const workbench::Solid sphere = workbench::make_sphere(4);
  const Bvh bvh = build(sphere.mesh());
  const std::vector<Ray> rays(4096, Ray{.origin = {0, 0, 0}, .direction = {1, 0.5f, 0.25f}});
  EXPECT_EQ(tiles_begun_within_another(static_cast<int>(test::reduced(2000)),
                                       [&] {
                                         std::vector<Hit> hits(rays.size());
                                         bvh.intersect(rays, hits);
                                       }),
            0);
  EXPECT_EQ(tiles_begun_within_another(static_cast<int>(test::reduced(50)), [&] { build(sphere.mesh()); }),
            0);
  EXPECT_EQ(tiles_begun_within_another(static_cast<int>(test::reduced(50)),
                                       [&] { build(sphere.mesh(), {.builder = Builder::esc}); }),
            0);
}

TEST(Concurrency, ABuildOnAllThreadsKeepsToTheCallersArena) {
  const workbench::Solid sphere = workbench::make_sphere(7);
  std::set<std::thread::id> threads;
  BuildOptions options;
  options.progress = [&](float) {
    threads.insert(std::this_thread::get_id());
    return true;
  };
  tbb::task_arena(1).execute([&] { build(sphere.mesh(), options); });
  EXPECT_EQ(threads.size(), 1u);
}
#endif

}  // namespace
}  // namespace kerf
