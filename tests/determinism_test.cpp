// The same bytes on every machine. No machine can compute, while a test runs, what another one would; so this
// test, unlike all others, compares with what was printed before: checksums from x86-64 with g++, which every
// other architecture, compiler, instruction set and version of Highway must find again. They change when a
// tree, the file format or a generated scene changes on purpose, and then on all machines alike. A test that
// fails prints the new ones.
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "files/checksum.hpp"
#include "math/vec3f.hpp"
#include "support/targets.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/generated_scenes.hpp"
#include "workbench/rays/rays.hpp"

namespace {

using kerf::Builder;

// Small scenes, which an emulated machine goes through in seconds.
workbench::Scene make_scene(std::string_view name) {
  const workbench::GeneratedScene& scene = *workbench::find_generated_scene(name);
  return scene.generate(1000.0 / static_cast<double>(scene.default_triangles));
}

// Of values that consist of floats and integers of four bytes, without a gap.
template <class T>
std::string checksum_of(std::span<const T> values) {
  return fmt::format("{:016x}", kerf::checksum(std::as_bytes(values)));
}

std::string checksum_of_file(const workbench::Scene& scene, Builder builder) {
  const TemporaryDirectory directory;
  kerf::build(scene.mesh(), {.builder = builder}).save(directory / "scene.kerf");
  return checksum_of(std::span<const char>(read_bytes(directory / "scene.kerf")));
}

std::string checksum_of_hits(const workbench::Scene& scene, const kerf::Bvh& bvh) {
  std::vector<kerf::Hit> all;
  for (const workbench::RayType type : {workbench::RayType::primary, workbench::RayType::diffuse}) {
    const std::vector<kerf::Ray> rays = make_rays(scene, bvh, type, {.width = 32, .height = 24}).rays;
    std::vector<kerf::Hit> hits(rays.size());
    bvh.intersect(rays, hits);
    all.insert(all.end(), hits.begin(), hits.end());
    for (const kerf::Ray& ray : rays) all.push_back(bvh.intersect(ray).value_or(kerf::Hit{}));
  }
  return checksum_of(std::span<const kerf::Hit>(all));
}

// What is asked at the points of a grid in the scene's box.
std::string checksum_of_answers(const kerf::Bvh& bvh) {
  const auto [lower, upper] = bvh.bounds();
  const kerf::Vec3f extent = upper - lower;
  std::vector<kerf::SurfacePoint> points;
  std::vector<std::uint32_t> numbers;
  constexpr int steps = 5;
  for (int i = 0; i < steps * steps * steps; ++i) {
    const auto along = [](int k) {
      return (static_cast<float>(k % steps) + 0.3f) / static_cast<float>(steps);
    };
    const kerf::Vec3f point{lower.x + along(i) * extent.x, lower.y + along(i / steps) * extent.y,
                            lower.z + along(i / (steps * steps)) * extent.z};
    points.push_back(bvh.closest_point(point).value_or(kerf::SurfacePoint{}));
    const std::vector<kerf::SurfacePoint> near = bvh.within(point, 0.02f * extent.x);
    points.insert(points.end(), near.begin(), near.end());
    numbers.push_back(bvh.contains(point));
    for (const kerf::PrimitiveId& id : bvh.triangles_in({point, point + 0.05f * extent})) {
      numbers.push_back(id.primitive);
    }
    bvh.all_hits({.origin = point, .direction = extent},
                 [&](const kerf::Hit& hit) { numbers.push_back(hit.primitive); });
  }
  return checksum_of(std::span<const kerf::SurfacePoint>(points)) +
         checksum_of(std::span<const std::uint32_t>(numbers));
}

}  // namespace

TEST(Determinism, FilesAreTheSameOnEveryMachine) {
  struct Expected {
    std::string_view scene, sbvh, bvh, esc, evh;
  };
  for (const Expected& expected : {
           Expected{"atrium", "a87199d93c51ec6f", "712152d847f14199", "2cc782fc85ecd94e", "54bb0c79407e7146"},
           Expected{"conference", "ba6a19462318e30f", "1880f484afcb0ace", "40e45846a055045b",
                    "2d16061ca1501351"},
           Expected{"hairball", "48efb27c93d2b7db", "4ada39587eb48fbd", "b6587a550f0725de",
                    "a3689105dabd9b43"},
           Expected{"city", "59e3eb53d9aaf804", "23d2d0048d03c632", "bb67909bb3aa83ab", "2538dc7402e5013a"},
           Expected{"terrain", "12d93fafaf844dbc", "169d1020ac20db96", "a23ecbe44673759c",
                    "db632eca3cc7bc73"},
           Expected{"sticks", "8aa20a787bd2fd59", "58d357c1c4cdbcb1", "62bf8000f5221e34", "6c4163852c01e319"},
       }) {
    SCOPED_TRACE(expected.scene);
    const workbench::Scene scene = make_scene(expected.scene);
    EXPECT_EQ(checksum_of_file(scene, Builder::bvh), expected.bvh);
    EXPECT_EQ(checksum_of_file(scene, Builder::esc), expected.esc);
    EXPECT_EQ(checksum_of_file(scene, Builder::evh), expected.evh);
    kerf_tests::for_each_target(
        [&](const kerf::Target&) { EXPECT_EQ(checksum_of_file(scene, Builder::sbvh), expected.sbvh); });
  }
}

TEST(Determinism, HitsAndAnswersAreTheSameOnEveryMachine) {
  struct Expected {
    std::string_view scene, hits, answers;
  };
  for (const Expected& expected : {
           Expected{"atrium", "0fc4b9c401d2456e", "0d6b393974e1b343b5175bb3acd64ded"},
           Expected{"conference", "2b3476a7be932992", "0ae6cbbb78be216a193442fb91a5c3a4"},
           Expected{"hairball", "f2cb7a13200a7c0b", "8f9ad3983bc02b4d041f44282247be4d"},
           Expected{"city", "06efed920969c875", "0227a44414ebe4fccb64ed36362b21f1"},
           Expected{"terrain", "d5be9e5ec123d888", "e55c91082875f3e8bbf2ffbbb5618939"},
           Expected{"sticks", "6fb75339fbaa12ff", "591f41e6f9b009b43b530d3ee9bf7492"},
       }) {
    SCOPED_TRACE(expected.scene);
    const workbench::Scene scene = make_scene(expected.scene);
    kerf_tests::for_each_target([&](const kerf::Target&) {
      const kerf::Bvh bvh = kerf::build(scene.mesh());
      EXPECT_EQ(checksum_of_hits(scene, bvh), expected.hits);
      EXPECT_EQ(checksum_of_answers(bvh), expected.answers);
    });
  }
}
