// What `compare` measures, against brute force over all triangles.
#include "workbench/compare/compare.hpp"

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>

#include "support/brute_force.hpp"
#include "support/instrumented.hpp"
#include "workbench/compare/json.hpp"
#include "workbench/compare/trace.hpp"
#include "workbench/open/load_scene.hpp"

using namespace workbench;

namespace {

const CompareOptions quick{
    .threads = 2, .rays = {.width = 16, .height = test::reduced(16)}, .seconds_per_type = 0.0};

std::vector<Contender> all_builders() {
  std::vector<Contender> contenders;
  for (const kerf::BuilderInfo& info : kerf::builders()) {
    contenders.push_back({.name = std::string(info.name), .options = {.builder = info.builder}});
  }
  return contenders;
}

}  // namespace

TEST(Compare, EveryHitOfEveryBuilderIsThatOfBruteForce) {
  for (const char* spec : {"sticks:detail=0.02,rotate=30", "atrium:detail=0.01"}) {
    const Scene scene = load_scene(spec);
    const Comparison comparison = compare(scene, all_builders(), quick);
    EXPECT_EQ(comparison.figures.disagreements(), 0u);
    for (const RayType type : ray_types) {
      const RaySet set = make_rays(scene, comparison.hierarchies.front(), type, quick.rays);
      std::vector<kerf::Hit> expected;
      std::size_t hits = 0;
      for (const kerf::Ray& ray : set.rays) {
        expected.push_back(brute_force(scene.mesh(), ray).value_or(kerf::Hit{}));
        hits += static_cast<bool>(expected.back());
      }
      for (std::size_t i = 0; i < comparison.hierarchies.size(); ++i) {
        const CountedPass pass = trace_counted(comparison.hierarchies[i], set, 1);
        const BuilderFigures& figures = comparison.figures.builders[i];
        EXPECT_EQ(figures.rays[static_cast<std::size_t>(type)].hits, hits) << spec << " " << figures.name;
        for (std::size_t r = 0; r < set.rays.size(); ++r) {
          EXPECT_EQ(static_cast<bool>(pass.hits[r]), static_cast<bool>(expected[r])) << r;
          if (!set.any_hit()) {
            EXPECT_EQ(pass.hits[r], expected[r]) << spec << " " << figures.name << " ray " << r;
          }
        }
      }
    }
  }
}

TEST(Compare, EscAndEvhHaveTheReferencesOfTheSbvh) {
  for (const char* spec : {"sticks:detail=0.05", "conference:detail=0.05"}) {
    const Comparison comparison = compare(load_scene(spec), all_builders(), quick);
    const auto& builders = comparison.figures.builders;
    EXPECT_GT(builders[1].references, builders[0].references);
    for (const std::size_t presplit : {std::size_t{2}, std::size_t{3}}) {
      EXPECT_NEAR(static_cast<double>(builders[presplit].references),
                  static_cast<double>(builders[1].references),
                  0.002 * static_cast<double>(builders[1].references))
          << spec << " " << builders[presplit].name;
    }
  }
}

TEST(Compare, ProgressNeverFallsAndEndsAtOne) {
  CompareOptions options = quick;
  double last = 0.0;
  options.progress = [&](double part, std::string_view what) {
    EXPECT_GE(part, last) << what;
    EXPECT_LE(part, 1.0) << what;
    last = part;
  };
  compare(load_scene("sticks:detail=0.01"), all_builders(), options);
  EXPECT_EQ(last, 1.0);
}

TEST(Compare, ASweepOverEqualTrianglesTracesFewRaysAndMeasuresEqualTreesOnce) {
  constexpr std::size_t count = 2000;
  Scene heap{
      .name = "heap", .vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {}, .viewpoints = {}};
  heap.triangles.assign(count, {0, 1, 2});
  heap.viewpoints = {{.position = {0.3f, 0.3f, 2}, .target = {0.3f, 0.3f, 0}, .up = {0, 1, 0}}};
  std::vector<Contender> sweep;
  for (const float alpha : {1.0f, 1e-1f, 1e-2f, 1e-3f, 1e-4f, 1e-5f, 1e-6f, 1e-7f, 0.0f})
    sweep.push_back({.name = "sbvh", .options = {.builder = kerf::Builder::sbvh, .alpha = alpha}});
  CompareOptions options = quick;
  options.rays = {.width = 64, .height = 64};
  options.max_visits = 4'000'000;
  std::size_t measured = 0;
  options.progress = [&](double, std::string_view what) { measured += what.starts_with("measure"); };
  const SceneFigures figures = compare(heap, sweep, options).figures;

  double tests = 0.0;
  for (const BuilderFigures& builder : figures.builders) {
    EXPECT_GT(builder.rays[0].hits, 0u);
    EXPECT_EQ(builder.sah, figures.builders[0].sah);
    EXPECT_EQ(builder.lcv, figures.builders[0].lcv);
    tests += static_cast<double>(builder.rays[0].count) * builder.rays[0].triangle_tests;
  }
  EXPECT_GE(tests, 1.0 * count);
  EXPECT_LE(tests, static_cast<double>(options.max_visits)) << "of all trees together";
  EXPECT_LE(measured, 3u) << "no alpha but the first and the last can order the references in another way";
  EXPECT_EQ(figures.disagreements(), 0u);
  EXPECT_NE(figures.remark.find("not 64x64"), std::string::npos) << figures.remark;
}

TEST(Compare, SaysOnceOfWhichBuildersTheEpoIsFromASample) {
  Scene heap{
      .name = "heap", .vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {}, .viewpoints = {}};
  heap.triangles.assign(20'000, {0, 1, 2});
  heap.viewpoints = {{.position = {0.3f, 0.3f, 2}, .target = {0.3f, 0.3f, 0}, .up = {0, 1, 0}}};
  CompareOptions options = quick;
  options.max_visits = 100'000;
  const std::vector<Contender> both{{.name = "bvh", .options = {.builder = kerf::Builder::bvh}},
                                    {.name = "sbvh", .options = {.builder = kerf::Builder::sbvh}}};
  const std::string remark = compare(heap, both, options).figures.remark;
  EXPECT_NE(remark.find("the EPO of bvh, sbvh is from a sample"), std::string::npos) << remark;
}

TEST(Compare, SaysWhereNoRayHitsAnything) {
  Scene line{
      .name = "line", .vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, .triangles = {}, .viewpoints = {}};
  line.triangles = {{0, 1, 2}};
  line.viewpoints = {{.position = {0.3f, 0.3f, 2}, .target = {0.3f, 0.3f, 0}, .up = {0, 1, 0}}};
  const SceneFigures figures = compare(line, all_builders(), quick).figures;
  const std::string remark = figures.remark;
  EXPECT_NE(remark.find("no ray hits anything"), std::string::npos) << remark;
  const auto rays = to_json(std::span(&figures, 1), "0.1.0")["scenes"][0]["builders"][0]["rays"];
  EXPECT_GT(rays["primary"]["mrays_per_s"], 0.0);
  EXPECT_TRUE(rays["ao"]["mrays_per_s"].is_null()) << "none was traced";
  EXPECT_TRUE(rays["ao"]["median_mrays_per_s"].is_null());
  const std::string of_sticks =
      compare(load_scene("sticks:detail=0.01"), all_builders(), quick).figures.remark;
  EXPECT_EQ(of_sticks.find("no ray hits anything"), std::string::npos) << of_sticks;
}
