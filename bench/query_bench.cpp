// The time of each spatial query on one thread, and of Embree's point query beside the closest point, if
// Embree is available.
//
//     build/release/bin/query_bench SCENE [--benchmark_...]      (the atrium if no scene is named)

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <kerf/kerf.hpp>

#include "bench/embree_points.hpp"
#include "workbench/bench/peers/flush_denormals.hpp"
#include "workbench/open/load_scene.hpp"

namespace {

using kerf::Vec3f;

struct Questions {
  std::vector<Vec3f> anywhere;  // in the box around the scene
  std::vector<Vec3f> near;      // up to a hundredth of its diagonal away from vertices, on each axis
  float radius;                 // a two-hundredth of the diagonal
};

Questions make_questions(const workbench::Scene& scene, const kerf::Box3f& box) {
  std::mt19937 random(1);
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * (static_cast<float>(random() >> 8) * 0x1p-24f);
  };
  const float diagonal =
      std::hypot(box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z);
  Questions questions;
  questions.radius = diagonal / 200;
  for (int i = 0; i < 10'000; ++i) {
    const float x = uniform(box.lower.x, box.upper.x), y = uniform(box.lower.y, box.upper.y),
                z = uniform(box.lower.z, box.upper.z);
    questions.anywhere.push_back({x, y, z});
    Vec3f vertex = scene.vertices[random() % scene.vertices.size()];
    for (float* coordinate : {&vertex.x, &vertex.y, &vertex.z})
      *coordinate += uniform(-diagonal, diagonal) / 100;
    questions.near.push_back(vertex);
  }
  return questions;
}

void run(const std::string& spec) {
  const workbench::Scene scene = workbench::load_scene(spec);
  const kerf::Bvh bvh = kerf::build(scene.mesh());
  const Questions questions = make_questions(scene, bvh.bounds());
  const bench::EmbreePoints embree(scene);
  // One question per iteration, at the points in rotation.
  const auto ask = [&](const std::string& name, auto question, auto set_up) {
    for (const auto& [where, points] :
         {std::pair("anywhere", &questions.anywhere), std::pair("near", &questions.near)}) {
      benchmark::RegisterBenchmark((name + "/" + where).c_str(),
                                   [points = points, question, set_up](benchmark::State& state) {
                                     [[maybe_unused]] const auto meanwhile = set_up();
                                     std::size_t next = 0;
                                     for (auto _ : state) {
                                       benchmark::DoNotOptimize(question((*points)[next]));
                                       next = next + 1 == points->size() ? 0 : next + 1;
                                     }
                                   });
    }
  };
  const auto nothing = [] { return 0; };
  ask(
      "ClosestPoint", [&](const Vec3f& p) { return bvh.closest_point(p); }, nothing);
  if (embree.available())
    ask(
        "EmbreeClosestPoint", [&](const Vec3f& p) { return embree.distance(p); },
        [] { return workbench::FlushDenormals(); });
  ask(
      "SignedDistance", [&](const Vec3f& p) { return bvh.signed_distance(p); }, nothing);
  ask(
      "Contains", [&](const Vec3f& p) { return bvh.contains(p); }, nothing);
  ask(
      "Within", [&](const Vec3f& p) { return bvh.within(p, questions.radius); }, nothing);
  ask(
      "TrianglesIn",
      [&](const Vec3f& p) {
        const float r = questions.radius;
        return bvh.triangles_in({{p.x - r, p.y - r, p.z - r}, {p.x + r, p.y + r, p.z + r}});
      },
      nothing);
  ask(
      "AllHits",
      [&](const Vec3f& p) {
        std::size_t count = 0;
        bvh.all_hits({.origin = p, .direction = {0.3f, 0.5f, 0.8f}}, [&](const kerf::Hit&) { ++count; });
        return count;
      },
      nothing);
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  try {
    run(argc > 1 ? argv[1] : "atrium:detail=4");
  } catch (const kerf::Error& error) {
    std::fprintf(stderr, "query_bench: %s\n", error.what());
    return 1;
  }
}
