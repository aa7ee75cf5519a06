// Comparisons that a device traces: here one that is none, but traces on the CPU.
#include "workbench/compare/device.hpp"

#include <gtest/gtest.h>

#include "workbench/compare/json.hpp"
#include "workbench/compare/table.hpp"
#include "workbench/open/load_scene.hpp"

using namespace workbench;

namespace {

// Traces as the library does. Its second structure loses the first hit of each set of rays.
class TestDevice final : public TracingDevice {
 public:
  std::string name() const override { return "a test"; }
  std::vector<std::string> structures() const override { return {"right", "wrong"}; }
  std::unique_ptr<DeviceHierarchy> upload(const kerf::Tree& tree, std::size_t structure) override {
    return std::make_unique<Uploaded>(make_bvh(tree), structure, set_);
  }
  void set_rays(const RaySet& set) override { set_ = set; }

 private:
  class Uploaded final : public DeviceHierarchy {
   public:
    Uploaded(kerf::Bvh bvh, std::size_t structure, const RaySet& set)
        : bvh_(std::move(bvh)), structure_(structure), set_(set) {}
    std::size_t references() const override { return bvh_.statistics().references; }
    std::size_t nodes() const override { return 10 + structure_; }
    std::size_t bytes() const override { return 100 + structure_; }
    CountedPass trace_counted() override {
      CountedPass pass = workbench::trace_counted(bvh_, set_, 1);
      for (kerf::Hit& hit : pass.hits) {
        if (structure_ == 0 || !hit) continue;
        hit = {};
        --pass.hit_count;
        break;
      }
      return pass;
    }
    double time() override { return structure_ == 0 ? 0.5 : 0.25; }

   private:
    const kerf::Bvh bvh_;
    const std::size_t structure_;
    const RaySet& set_;
  };

  RaySet set_{};
};

Comparison traced_by(TracingDevice& device) {
  const std::vector<Contender> contenders{{.name = "bvh", .options = {.builder = kerf::Builder::bvh}},
                                          {.name = "sbvh", .options = {.builder = kerf::Builder::sbvh}}};
  return compare(load_scene("conference:detail=0.01"), contenders,
                 {.device = &device,
                  .threads = 1,
                  .rays = {.width = 16, .height = 16},
                  .rounds = 1,
                  .seconds_per_type = 0.0});
}

}  // namespace

TEST(CompareOnDevice, EachTreeIsTracedInEachStructure) {
  TestDevice device;
  const SceneFigures scene = traced_by(device).figures;
  EXPECT_EQ(scene.device, "a test");
  ASSERT_EQ(scene.builders.size(), 4u);
  const char* names[] = {"bvh", "bvh", "sbvh", "sbvh"};
  for (std::size_t i = 0; i < 4; ++i) {
    const BuilderFigures& figures = scene.builders[i];
    EXPECT_EQ(figures.name, names[i]);
    EXPECT_EQ(figures.structure, i % 2 == 0 ? "right" : "wrong");
    EXPECT_EQ(figures.nodes, 10 + i % 2);
    EXPECT_EQ(figures.bytes, 100 + i % 2);
    EXPECT_EQ(figures.sah, scene.builders[i - i % 2].sah);
    EXPECT_GT(figures.sah, 0.0);
    EXPECT_GT(figures.build_ms, 0.0);
    EXPECT_LT(figures.build_ms, 1e9);
    for (const RayFigures& rays : figures.rays) {
      EXPECT_GT(rays.steps, 0.0);
      EXPECT_DOUBLE_EQ(rays.mrays_per_s, 1e-6 * static_cast<double>(rays.count) / (i % 2 == 0 ? 0.5 : 0.25));
    }
  }
}

TEST(CompareOnDevice, HitsThatAreNotThoseOfTheCpuAreCounted) {
  TestDevice device;
  const SceneFigures scene = traced_by(device).figures;
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(scene.builders[i].disagreements, i % 2 == 0 ? 0u : std::size(ray_types));
  EXPECT_NE(format_comparison(scene, Emphasis::mark).find("6 HITS DIFFER from those of the CPU"),
            std::string::npos);
}

TEST(CompareOnDevice, TableAndJsonNameTheDeviceAndTheStructures) {
  TestDevice device;
  const SceneFigures scene = traced_by(device).figures;
  const std::string table = format_comparison(scene, Emphasis::mark);
  EXPECT_NE(table.find("traced by a test"), std::string::npos);
  EXPECT_NE(table.find("sbvh wrong"), std::string::npos);
  const auto json = to_json(std::span(&scene, 1), "0.1.0");
  EXPECT_EQ(json["device"], "a test");
  EXPECT_EQ(json["scenes"][0]["builders"][3]["name"], "sbvh");
  EXPECT_EQ(json["scenes"][0]["builders"][3]["structure"], "wrong");
  EXPECT_EQ(json["scenes"][0]["builders"][3]["alpha"], 1e-5);
}

TEST(CompareOnDevice, WithoutOneTheJsonNamesNeither) {
  SceneFigures scene{.name = "s", .triangles = 1, .degenerate_triangles = 0, .builders = {}};
  scene.builders.resize(1);
  const auto json = to_json(std::span(&scene, 1), "0.1.0");
  EXPECT_FALSE(json.contains("device"));
  EXPECT_FALSE(json["scenes"][0]["builders"][0].contains("structure"));
}
