// Builds and queries from many threads at the same time, for ThreadSanitizer and for the answers.
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "support/adversarial.hpp"
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

}  // namespace
}  // namespace kerf
