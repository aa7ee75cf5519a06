#include "workbench/bench/bench.hpp"

#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "workbench/bench/peers/embree.hpp"
#include "workbench/bench/peers/kerf_engine.hpp"
#include "workbench/bench/report.hpp"
#include "workbench/open/load_scene.hpp"

namespace workbench {
namespace {

BenchOptions short_run(unsigned threads) {
  BenchOptions options;
  options.threads = threads;
  options.build_rounds = 1;
  options.trace_rounds = 1;
  options.trace_seconds = 0.0;
  options.rays = {.width = 32, .height = 24};
  return options;
}

std::vector<Engine> all_engines(unsigned threads) {
  kerf::BuildOptions options;
  options.threads = threads;
  std::vector<Engine> engines{kerf_engine(options, "0")};
  const std::vector<std::string> isas = embree_isas();
  if (isas.empty()) return engines;
  for (Engine& engine : embree_engines(threads, isas.back())) engines.push_back(std::move(engine));
  return engines;
}

TEST(Bench, AllEnginesHitTheSameOfTheSameRays) {
  for (const unsigned threads : {1u, 2u}) {
    const BenchScene figures =
        bench_scene(load_scene("terrain:detail=0.01"), all_engines(threads), short_run(threads));
    ASSERT_GE(figures.results.size(), 2u);
    const BenchResult& first = figures.results[0];
    ASSERT_EQ(first.rays.size(), 3u);
    EXPECT_GT(first.rays[0].hits, 100u);
    for (const BenchResult& result : figures.results) {
      EXPECT_GT(result.build_ms, 0.0);
      EXPECT_GT(result.bytes, 0u);
      EXPECT_GE(result.build_peak_bytes, result.bytes);
      for (std::size_t i = 0; i < first.rays.size(); ++i) {
        EXPECT_EQ(result.rays[i].type, ray_types[i]);
        EXPECT_EQ(result.rays[i].count, first.rays[i].count);
        // A peer may let a ray through between two triangles.
        EXPECT_NEAR(static_cast<double>(result.rays[i].hits), static_cast<double>(first.rays[i].hits), 2.0)
            << result.engine << " " << name(ray_types[i]);
      }
    }
  }
}

TEST(Bench, RaysMadeOnTheSpotHitTheSameAsThoseInAnArrayToTheLastBit) {
  const Scene scene = load_scene("terrain:detail=0.01");
  std::vector<kerf::Vec3f> vertices = scene.vertices;
  vertices.emplace_back();  // Embree reads 16 bytes from the last vertex
  const kerf::TriangleMesh mesh{.vertices = {vertices.data(), scene.vertices.size(), sizeof(kerf::Vec3f)},
                                .triangles = scene.triangles};
  const kerf::Bvh bvh = kerf::build(mesh);
  constexpr std::size_t first = 100;  // blocks and slices start anywhere
  for (const unsigned threads : {1u, 2u}) {
    std::size_t tracers = 0;
    for (const Engine& engine : all_engines(threads)) {
      for (const Tracer& tracer : engine.build(mesh).tracers) {
        ASSERT_EQ(bool(tracer.intersect_made), tracer.mode == "single");
        ASSERT_EQ(bool(tracer.occluded_made), tracer.mode == "single");
        if (tracer.mode != "single") continue;
        ++tracers;
        for (const RayType type : ray_types) {
          const RaySet set = make_rays(scene, bvh, type, {.width = 64, .height = 48});
          const auto rays = std::span(set.rays).subspan(first);
          ASSERT_GT(rays.size(), 1000u);
          std::vector<kerf::Hit> array(rays.size()), made(rays.size());
          tracer.intersect(rays, array);
          tracer.intersect_made(set, first, made);
          EXPECT_EQ(made, array) << tracer.engine << " " << name(type);
          std::vector<std::uint8_t> array_occluded(rays.size()), made_occluded(rays.size());
          tracer.occluded(rays, array_occluded);
          tracer.occluded_made(set, first, made_occluded);
          EXPECT_EQ(made_occluded, array_occluded) << tracer.engine << " " << name(type);
        }
      }
    }
    EXPECT_GE(tracers, embree_isas().empty() ? 1u : 4u);
  }
}

TEST(Bench, OnlySingleRaysAreMadeOnTheSpot) {
  BenchOptions options = short_run(1);
  const Scene scene = load_scene("terrain:detail=0.002");
  for (const RaysMade wanted : {RaysMade::made, RaysMade::array}) {
    options.rays_made = {wanted};
    for (const BenchResult& result : bench_scene(scene, all_engines(1), options).results) {
      EXPECT_EQ(result.rays_made, result.mode == "single" ? wanted : RaysMade::array) << result.mode;
    }
  }
}

TEST(Bench, WithEmbreeHasEveryEngine) {
  if (embree_isas().empty()) GTEST_SKIP() << "built without Embree";
  const BenchScene figures = bench_scene(load_scene("terrain:detail=0.002"), all_engines(1), short_run(1));
  std::set<std::string> found;
  for (const BenchResult& result : figures.results) found.insert(result.engine + " " + result.mode);
  for (const std::string expected : {"kerf single", "kerf batch", "embree-high single",
                                     "embree-high-robust single", "embree-medium single"}) {
    EXPECT_TRUE(found.contains(expected)) << expected;
  }
}

// One scene, on which kerf is `factor` times as fast as the peer.
BenchScene made_up(const std::string& name, double factor) {
  BenchScene scene{.name = name, .triangles = 10, .results = {}};
  for (const bool kerf : {true, false}) {
    BenchResult result{.engine = kerf ? "kerf" : "peer",
                       .mode = "single",
                       .isa = kerf ? "AVX2" : "avx",
                       .rays_made = RaysMade::made,
                       .build_ms = kerf ? 1.0 : 3.0,
                       .bytes = kerf ? 50u : 100u,
                       .build_peak_bytes = 200,
                       .rays = {}};
    for (const RayType type : ray_types) {
      result.rays.push_back({.type = type, .count = 5, .hits = 4, .mrays_per_s = kerf ? factor : 1.0});
    }
    scene.results.push_back(result);
  }
  return scene;
}

TEST(Bench, RatiosAreGeometricMeansAndMinima) {
  const BenchScene scenes[] = {made_up("slow", 0.5), made_up("fast", 8.0)};
  const std::vector<Ratios> ratios = ratios_to_peers(scenes);
  ASSERT_EQ(ratios.size(), 1u);
  EXPECT_EQ(ratios[0].peer, "peer");
  EXPECT_NEAR(ratios[0].mean, 2.0, 1e-12);
  EXPECT_NEAR(ratios[0].primary_mean, 2.0, 1e-12);
  EXPECT_EQ(ratios[0].min, 0.5);
  EXPECT_EQ(ratios[0].min_scene, "slow");
  EXPECT_NEAR(ratios[0].build_mean, 3.0, 1e-12);
  EXPECT_EQ(ratios[0].bytes_max, 0.5);
  EXPECT_EQ(ratios[0].peak_bytes_max, 1.0);
}

TEST(Bench, TheTableHasCommasInCountsAndDigitsInTheSlowestSpeeds) {
  BenchScene scene = made_up("heap", 1.0);
  scene.triangles = 100'000;
  scene.references = 123'456;
  scene.results[0].rays[0].mrays_per_s = 0.000213;
  const std::string text = format_bench(std::span(&scene, 1), Emphasis::mark);
  EXPECT_NE(text.find("100,000 triangles, 123,456 references"), std::string::npos) << text;
  EXPECT_NE(text.find("0.000213"), std::string::npos) << text;
}

TEST(Bench, RemarksOnAPeerThatHitsMuchLess) {
  BenchScene scene = made_up("flat", 1.0);
  for (BenchResult& result : scene.results) {
    for (BenchRays& rays : result.rays) rays.count = 200'000, rays.hits = 118'805;
  }
  EXPECT_TRUE(remarks_on(scene).empty());
  scene.results[1].rays[1].hits -= 12;
  EXPECT_TRUE(remarks_on(scene).empty()) << "a few rays leak";
  for (BenchRays& rays : scene.results[1].rays) rays.hits = 17'445;
  const std::vector<std::string> remarks = remarks_on(scene);
  ASSERT_EQ(remarks.size(), 1u) << "one for each peer";
  EXPECT_TRUE(remarks[0].starts_with("peer hits 17445 of the 200000 rays that kerf hits 118805 of, primary."))
      << remarks[0];
  scene.remarks = remarks;
  EXPECT_NE(format_bench(std::span(&scene, 1), Emphasis::mark).find("Note: peer hits"), std::string::npos);
  EXPECT_EQ(to_json(std::span(&scene, 1), {.version = "0.1.0", .target = {}})["scenes"][0]["remarks"].size(),
            1u);
}

TEST(Bench, RatiosAreOfRaysThatThereAre) {
  BenchScene scene = made_up("nothing is hit", 2.0);
  for (BenchResult& result : scene.results) {
    for (std::size_t i = 1; i < 3; ++i) result.rays[i] = {.type = ray_types[i]};
  }
  EXPECT_EQ(ratios_to_peers(std::span(&scene, 1))[0].mean, 2.0);
}

TEST(Bench, WhereNothingIsHitThereAreNeitherSpeedsNorRatios) {
  // All triangles are points or lines.
  const Scene nothing{.name = "nothing",
                      .vertices = {{0, 0, 0}, {1, 0, 0}},
                      .triangles = {{0, 0, 1}, {1, 1, 1}},
                      .viewpoints = {{.position = {0, 0, 2}, .target = {0, 0, 0}, .up = {0, 1, 0}}}};
  BenchOptions options = short_run(1);
  options.limits = true;
  const BenchScene figures = bench_scene(nothing, all_engines(1), options);
  EXPECT_GT(figures.results[0].rays[0].count, 0u);
  const auto json = to_json(std::span(&figures, 1), {.version = "0.1.0", .target = {}})["scenes"][0];
  for (const auto& result : json["results"]) {
    for (const auto& [type, rays] : result["rays"].items()) {
      EXPECT_TRUE(rays["mrays_per_s"].is_null()) << result["engine"] << " " << type;
      EXPECT_EQ(rays["hits"], 0);
    }
  }
  for (const auto& [type, rays] : json["limits"]["rays"].items()) EXPECT_TRUE(rays["efficiency"].is_null());
  for (const Ratios& ratios : ratios_to_peers(std::span(&figures, 1))) {
    for (const double ratio : {ratios.mean, ratios.primary_mean, ratios.min, ratios.build_mean,
                               ratios.build_min, ratios.bytes_max, ratios.peak_bytes_max})
      EXPECT_EQ(ratio, 0.0) << ratios.peer;
  }
  const std::string text = format_bench(std::span(&figures, 1), Emphasis::mark);
  EXPECT_NE(text.find(" - "), std::string::npos) << text;
  EXPECT_EQ(text.find("0x"), std::string::npos) << text;
  EXPECT_EQ(text.find("inf"), std::string::npos) << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

TEST(Bench, RaysMadeAndInAnArrayAreComparedEachWithItsOwnKindAndWithEachOther) {
  BenchScene scene = made_up("one", 3.0);
  BenchScene array = made_up("one", 6.0);
  for (BenchResult& result : array.results) {
    result.rays_made = RaysMade::array;
    if (result.engine == "peer") result.rays[0].mrays_per_s = 0.75;
    scene.results.push_back(result);
  }
  scene.results.push_back(
      scene.results[2]);  // spans, which are compared with the rays of a peer that are made
  scene.results.back().mode = "batch";
  std::map<std::string, double> means;
  for (const Ratios& r : ratios_to_peers(std::span(&scene, 1))) {
    const std::string key = r.mode + ", " + std::string(name(r.rays_made)) + " over " + r.peer;
    EXPECT_TRUE(means.emplace(key, r.primary_mean).second) << key;
  }
  EXPECT_EQ(means.size(), 4u);
  EXPECT_NEAR(means["single, made over peer"], 3.0, 1e-12);
  EXPECT_NEAR(means["single, array over peer"], 8.0, 1e-12);
  EXPECT_NEAR(means["single, made over kerf single, array"], 0.5, 1e-12);
  EXPECT_NEAR(means["batch, array over peer"], 6.0, 1e-12);
}

TEST(Bench, JsonHasItsKeys) {
  const BenchScene scenes[] = {made_up("one", 1.0)};
  const auto json = to_json(scenes, {.version = "0.1.0", .threads = 2, .target = "AVX2"});
  EXPECT_EQ(json["kerf"], "0.1.0");
  EXPECT_EQ(json["threads"], 2);
  EXPECT_EQ(json["target"], "AVX2");
  EXPECT_EQ(json["scenes"][0]["name"], "one");
  EXPECT_EQ(json["scenes"][0]["triangles"], 10);
  const auto& result = json["scenes"][0]["results"][1];
  EXPECT_EQ(result["engine"], "peer");
  EXPECT_EQ(result["mode"], "single");
  EXPECT_EQ(result["isa"], "avx");
  EXPECT_EQ(result["rays_made"], "made");
  EXPECT_EQ(result["build_ms"], 3.0);
  EXPECT_EQ(result["bytes"], 100);
  EXPECT_EQ(result["build_peak_bytes"], 200);
  for (const char* type : {"primary", "ao", "diffuse"}) {
    EXPECT_EQ(result["rays"][type]["count"], 5);
    EXPECT_EQ(result["rays"][type]["hits"], 4);
    EXPECT_EQ(result["rays"][type]["mrays_per_s"], 1.0);
  }
}

TEST(Bench, LimitsAreMeasuredWhereTheyAreAskedFor) {
  BenchOptions options = short_run(1);
  const Scene scene = load_scene("terrain:detail=0.01");
  const std::vector<Engine> kerf_alone{kerf_engine({.threads = 1}, "0")};
  EXPECT_FALSE(bench_scene(scene, kerf_alone, options).limits);
  options.limits = true;
  const BenchScene figures = bench_scene(scene, kerf_alone, options);
  ASSERT_TRUE(figures.limits);
  EXPECT_GT(figures.limits->times.node_ns, 0.0);
  EXPECT_GT(figures.limits->times.leaf_ns, 0.0);
  const kerf::Bvh bvh = kerf::build(scene.mesh());
  for (std::size_t i = 0; i < std::size(ray_types); ++i) {
    const StepCounts counts = count_steps(bvh, make_rays(scene, bvh, ray_types[i], options.rays));
    EXPECT_EQ(figures.limits->counts[i].nodes, counts.nodes);
    EXPECT_EQ(figures.limits->counts[i].leaves, counts.leaves);
    EXPECT_GT(counts.nodes, 1.0);
  }
}

TEST(Bench, TheFloorIsTheTimeOfTheStepsAndEfficiencyItsFractionOfTheTimeTaken) {
  BenchScene scene = made_up("one", 20.0);  // 50 ns a ray
  scene.limits = {.times = {.node_ns = 3.0, .leaf_ns = 5.0}, .counts = {}};
  scene.limits->counts[1] = {.nodes = 5.0, .leaves = 2.0};
  const auto json = to_json(std::span(&scene, 1), {.version = "0.1.0", .target = {}})["scenes"][0]["limits"];
  EXPECT_EQ(json["node_ns"], 3.0);
  EXPECT_EQ(json["leaf_ns"], 5.0);
  EXPECT_EQ(json["rays"]["ao"]["steps"], 5.0);
  EXPECT_EQ(json["rays"]["ao"]["leaves"], 2.0);
  EXPECT_EQ(json["rays"]["ao"]["floor_ns"], 25.0);
  EXPECT_NEAR(json["rays"]["ao"]["efficiency"]["single"], 0.5, 1e-12);
  EXPECT_NE(format_bench(std::span(&scene, 1), Emphasis::mark).find("25.0"), std::string::npos);
}

}  // namespace
}  // namespace workbench
