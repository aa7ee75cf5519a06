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
#include "support/node_width.hpp"
#include "support/targets.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/base/vectors.hpp"
#include "workbench/generate/generated_scenes.hpp"
#include "workbench/rays/rays.hpp"

namespace {

using kerf::Builder;
using workbench::operator+, workbench::operator-, workbench::operator*;

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

// Of the file of a machine whose nodes have `width` children.
std::string checksum_of_file(const workbench::Scene& scene, Builder builder, std::uint32_t width) {
  const TemporaryDirectory directory;
  kerf_tests::build_with_node_width(scene.mesh(), {.builder = builder}, width).save(directory / "scene.kerf");
  return checksum_of(std::span<const char>(read_bytes(directory / "scene.kerf")));
}

std::string checksum_of_refined_file(const workbench::Scene& scene, kerf::Quality quality) {
  const TemporaryDirectory directory;
  kerf_tests::build_with_node_width(scene.mesh(), {.quality = quality}, 16).save(directory / "scene.kerf");
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
    std::string_view scene, sbvh_16, sbvh_8, sbvh_4, bvh, esc, evh;
  };
  for (const Expected& expected : {
           Expected{"atrium", "b15d752cfb3abc84", "1a417d14c71a340f", "af3c433d224518de", "1acd159f72770e2d",
                    "d1bd52ba2d4ef2cb", "991271df7d0b504f"},
           Expected{"conference", "1d574ac8e183aff1", "58b57f087fd2e544", "dd35c0fee54e6ee0",
                    "001dc72d6c241c78", "1594f98eadc350cd", "ecea434435a4bbd5"},
           Expected{"hairball", "8431738151cbd764", "8661c123d4aa8917", "00c79ac395e38889",
                    "78f4c7a7b1ee78ad", "c025a12306730488", "22f3deb6f3a9ea8a"},
           Expected{"city", "9fed0d6f34f33234", "343d224894f79a30", "80107f7022af1749", "2533cf82e2ec75f3",
                    "f8840eebfa362a7a", "267522162c2c3fc3"},
           Expected{"terrain", "9698e735728a1d26", "a60474537c6cbe96", "e443cba480c431c7", "9dd585bd0d1f31c8",
                    "320a2e640453a34e", "dfa579d8b0d4fe00"},
           Expected{"sticks", "6f1803ee42fee789", "c23cf9035922a7b2", "a8702381d10b8312", "2adaf241734c2494",
                    "1724ce5a067ea5c2", "be4b47d74aec8ded"},
       }) {
    SCOPED_TRACE(expected.scene);
    const workbench::Scene scene = make_scene(expected.scene);
    EXPECT_EQ(checksum_of_file(scene, Builder::bvh, 16), expected.bvh);
    EXPECT_EQ(checksum_of_file(scene, Builder::esc, 16), expected.esc);
    EXPECT_EQ(checksum_of_file(scene, Builder::evh, 16), expected.evh);
    kerf_tests::for_each_target([&](const kerf::Target&) {
      EXPECT_EQ(checksum_of_file(scene, Builder::sbvh, 16), expected.sbvh_16);
      EXPECT_EQ(checksum_of_file(scene, Builder::sbvh, 8), expected.sbvh_8);
      EXPECT_EQ(checksum_of_file(scene, Builder::sbvh, 4), expected.sbvh_4);
    });
  }
}

TEST(Determinism, RefinedTreesAreTheSameOnEveryMachine) {
  struct Expected {
    std::string_view scene, high, best;
  };
  for (const Expected& expected : {
           Expected{"atrium", "ed156f85e35226d4", "ed86d94350f9d8f8"},
           Expected{"city", "b5f4fec31c499cc1", "579ec721c1531fbe"},
           Expected{"sticks", "63d6ec0b7f84429e", "f17e635887302fb4"},
       }) {
    SCOPED_TRACE(expected.scene);
    const workbench::Scene scene = make_scene(expected.scene);
    EXPECT_EQ(checksum_of_refined_file(scene, kerf::Quality::high), expected.high);
    EXPECT_EQ(checksum_of_refined_file(scene, kerf::Quality::best), expected.best);
  }
}

TEST(Determinism, HitsAndAnswersAreTheSameOnEveryMachine) {
  struct Expected {
    std::string_view scene, hits, answers;
  };
  for (const Expected& expected : {
           Expected{"atrium", "b585311206dd5620", "0d6b393974e1b343b5175bb3acd64ded"},
           Expected{"conference", "b00819d3b42dc1ad", "0ae6cbbb78be216a193442fb91a5c3a4"},
           Expected{"hairball", "332936dac9aec18b", "8f9ad3983bc02b4d041f44282247be4d"},
           Expected{"city", "c96e56a35795794c", "0227a44414ebe4fccb64ed36362b21f1"},
           Expected{"terrain", "79d417b179ca6f53", "e55c91082875f3e8bbf2ffbbb5618939"},
           Expected{"sticks", "6235a309b9d95541", "591f41e6f9b009b43b530d3ee9bf7492"},
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
