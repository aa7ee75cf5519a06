#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "workbench/bench/bench.hpp"
#include "workbench/bench/motion_report.hpp"
#include "workbench/bench/peers/embree.hpp"
#include "workbench/bench/peers/kerf_engine.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/scene/bend.hpp"

namespace workbench {
namespace {

BenchOptions short_run() {
  BenchOptions options;
  options.trace_rounds = 1;
  options.trace_seconds = 0.0;
  options.rays = {.width = 32, .height = 24};
  return options;
}

std::vector<Engine> engines_of_one_thread() {
  std::vector<Engine> engines{kerf_engine({.threads = 1}, "0")};
  const std::vector<std::string> isas = embree_isas();
  if (isas.empty()) return engines;
  for (Engine& engine : embree_engines(1, isas.back())) engines.push_back(std::move(engine));
  return engines;
}

TEST(Motion, EveryWayOfEveryEngineHitsTheSameThroughTheLastFrame) {
  const Scene scene = load_scene("terrain:detail=0.01");
  const MotionScene figures =
      bench_motion(scene, engines_of_one_thread(), short_run(), {.amount = 0.1, .frames = 2});
  std::set<std::string> ways;
  for (const MotionResult& result : figures.results) {
    ways.insert(result.engine + " " + result.motion);
    EXPECT_GT(result.frame_ms, 0.0);
    ASSERT_EQ(result.rays.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const BenchRays& rays = result.rays[i];
      EXPECT_EQ(rays.count, figures.results[0].rays[i].count);
      // A peer may let a ray through between two triangles.
      EXPECT_NEAR(static_cast<double>(rays.hits), static_cast<double>(figures.results[0].rays[i].hits), 2.0)
          << result.engine << " " << result.motion;
    }
  }
  EXPECT_TRUE(ways.contains("kerf refit") && ways.contains("kerf rebuild"));
  const bool has_embree = !embree_isas().empty();
  for (const std::string way : {"embree refit", "embree-low rebuild", "embree-medium rebuild"})
    EXPECT_EQ(ways.contains(way), has_embree) << way;
}

TEST(Motion, WhatIsTracedHasMoved) {
  const Scene rest = load_scene("terrain:detail=0.01");
  std::vector<kerf::Vec3f> vertices = rest.vertices;
  vertices.emplace_back();  // Embree reads 16 bytes from the last vertex
  const kerf::TriangleMesh mesh{.vertices = {vertices.data(), rest.vertices.size(), sizeof(kerf::Vec3f)},
                                .triangles = rest.triangles};
  for (const Engine& engine : engines_of_one_thread()) {
    if (!engine.movers) continue;
    for (const Mover& mover : engine.movers(mesh)) {
      for (const double phase : {0.2, 1.9}) {
        bend(rest.vertices, 0.2, phase, std::span(vertices).first(rest.vertices.size()));
        mover.next_frame();
        const auto& t = rest.triangles[rest.triangles.size() / 2];
        const kerf::Vec3f &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]];
        kerf::Vec3f middle;
        for (int axis = 0; axis < 3; ++axis) middle[axis] = (a[axis] + b[axis] + c[axis]) / 3.0f;
        const kerf::Vec3f e{b.x - a.x, b.y - a.y, b.z - a.z}, f{c.x - a.x, c.y - a.y, c.z - a.z};
        const kerf::Vec3f n{e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
        const kerf::Ray ray{.origin = {middle.x + n.x, middle.y + n.y, middle.z + n.z},
                            .direction = {-n.x, -n.y, -n.z}};
        std::vector<kerf::Hit> hits(1);
        mover.tracer().intersect(std::span(&ray, 1), hits);
        EXPECT_EQ(hits[0].primitive, rest.triangles.size() / 2) << mover.engine << " " << mover.motion;
        EXPECT_NEAR(hits[0].t, 1.0f, 1e-3f);
      }
    }
    vertices = rest.vertices;
    vertices.emplace_back();
  }
}

TEST(Motion, IsTold) {
  MotionScene scene{.name = "flag", .triangles = 10, .amount = 0.03, .results = {}};
  for (const bool refits : {true, false}) {
    MotionResult result{.engine = "kerf",
                        .motion = refits ? "refit" : "rebuild",
                        .isa = "AVX2",
                        .frame_ms = refits ? 1.25 : 9.5,
                        .rays = {}};
    for (const RayType type : ray_types)
      result.rays.push_back({.type = type, .count = 5, .hits = 4, .mrays_per_s = refits ? 2.0 : 3.0});
    scene.results.push_back(result);
  }
  const std::string text = format_motion(std::span(&scene, 1), Emphasis::mark);
  EXPECT_NE(text.find("flag: 10 triangles, bent by up to 3 % of the extent"), std::string::npos) << text;
  EXPECT_NE(text.find("1.25*"), std::string::npos) << "the shortest frame is marked";
  EXPECT_NE(text.find("3.00*"), std::string::npos) << "so are the fastest rays";
  const nlohmann::ordered_json json = to_json(std::span(&scene, 1), {.version = "0.1.0", .target = "AVX2"});
  EXPECT_EQ(json["scenes"][0]["motion"], 0.03);
  EXPECT_EQ(json["scenes"][0]["results"][1]["motion"], "rebuild");
  EXPECT_EQ(json["scenes"][0]["results"][1]["frame_ms"], 9.5);
  EXPECT_EQ(json["scenes"][0]["results"][0]["rays"]["ao"]["hits"], 4);
  EXPECT_EQ(json["scenes"][0]["results"][0]["rays_made"], "made");
}

TEST(Motion, OfRaysThatHitNothingHasNoSpeed) {
  MotionScene scene{.name = "nothing", .triangles = 2, .amount = 0.03, .results = {}};
  MotionResult& result = scene.results.emplace_back();
  for (const RayType type : ray_types) result.rays.push_back({.type = type, .count = 5, .mrays_per_s = 7.0});
  const std::string text = format_motion(std::span(&scene, 1), Emphasis::mark);
  EXPECT_NE(text.find(" - "), std::string::npos) << text;
  EXPECT_EQ(text.find("7.00"), std::string::npos) << text;
  const nlohmann::ordered_json json = to_json(std::span(&scene, 1), {.version = "0.1.0", .target = "AVX2"});
  EXPECT_TRUE(json["scenes"][0]["results"][0]["rays"]["primary"]["mrays_per_s"].is_null());
}

}  // namespace
}  // namespace workbench
