// .kerf files of scenes: what is saved comes back, each object once, and what is damaged does not.
#include <algorithm>
#include <cstring>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "fuzz/forged_file.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/instrumented.hpp"
#include "support/node_width.hpp"
#include "support/placed.hpp"
#include "support/targets.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using kerf_tests::any_transform;
using Bytes = std::vector<std::byte>;

// The code and the sentence of the error that `work` throws.
template <class Work>
std::pair<int, std::string> error_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {-1, "no error"};
}
std::string sentence(const Bytes& bytes) {
  const auto [code, what] = error_of([&] { Scene::load(bytes); });
  EXPECT_EQ(code, Error::bad_format);
  return what;
}

void expect_same_answers(const Scene& scene, const Scene& expected, std::mt19937& random) {
  ASSERT_EQ(scene.instance_count(), expected.instance_count());
  ASSERT_EQ(scene.bounds(), expected.bounds());
  for (std::size_t i = 0; i < test::reduced(300); ++i) {
    const Ray ray{.origin = adversarial::uniform_point(random, 20.0f),
                  .direction = adversarial::uniform_point(random, 1.0f)};
    ASSERT_EQ(scene.intersect(ray), expected.intersect(ray));
    ASSERT_EQ(scene.intersect(ray, Mask{2}), expected.intersect(ray, Mask{2}));
    ASSERT_EQ(scene.count_hits(ray), expected.count_hits(ray));
    if (i % 8 != 0) continue;
    ASSERT_EQ(scene.closest_point(ray.origin), expected.closest_point(ray.origin));
  }
}

TEST(SceneFile, LoadedAndMappedAnswerAsSaved) {
  std::mt19937 random(1);
  const workbench::Solid torus = workbench::make_torus(24, 12);
  const Scene scene = kerf_tests::scene_of_scenes(random, build(torus.mesh(), spatial_splits_everywhere()));
  const TemporaryDirectory directory;
  scene.save(directory / "scene.kerf");
  const Bytes bytes = scene.save();
  const std::string file = read_bytes(directory / "scene.kerf");
  EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(file)), bytes));
  for (const Scene& again :
       {Scene::load(directory / "scene.kerf"), Scene::map(directory / "scene.kerf"), Scene::load(bytes)}) {
    expect_same_answers(again, scene, random);
    EXPECT_EQ(again.save(), bytes);
    ASSERT_EQ(again.instances().size(), scene.instances().size());
    for (std::size_t i = 0; i < scene.instances().size(); ++i) {
      const Instance &a = again.instances()[i], &b = scene.instances()[i];
      EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(a.transform.rows)),
                                     std::as_bytes(std::span(b.transform.rows))));
      EXPECT_EQ(a.mask, b.mask);
      EXPECT_EQ(a.number, b.number);
    }
  }
}

TEST(SceneFile, AnObjectIsStoredOnceHoweverOftenItStands) {
  std::mt19937 random(2);
  const Bvh sphere = build(workbench::make_sphere(4).mesh()),
            torus = build(workbench::make_torus(9, 9).mesh());
  std::vector<Instance> inner, outer;
  for (std::uint32_t i = 0; i < 20; ++i)
    inner.push_back({.object = i % 2 == 0 ? sphere : torus, .transform = any_transform(random, 1)});
  const Scene row = build(inner);
  for (std::uint32_t i = 0; i < 20; ++i)
    outer.push_back({.scene = row, .transform = any_transform(random, 1), .number = i});
  outer.push_back({.object = sphere});
  const Scene scene = build(outer);
  const Bytes bytes = scene.save();
  const std::size_t tables = 64 + 4 * 8 + 41 * 112;
  EXPECT_EQ(bytes.size(), (tables + 63) / 64 * 64 + sphere.save().size() + torus.save().size());

  const Scene again = Scene::load(bytes);
  std::set<const void*> objects, scenes;
  for (const Instance& instance : again.instances()) {
    if (instance.scene.instances().empty()) {
      objects.insert(instance.object.identity());
      continue;
    }
    scenes.insert(instance.scene.identity());
    for (const Instance& inside : instance.scene.instances()) objects.insert(inside.object.identity());
  }
  EXPECT_EQ(objects.size(), 2u);
  EXPECT_EQ(scenes.size(), 1u);
  expect_same_answers(again, scene, random);
}

TEST(SceneFile, ScenesOfNothingSurvive) {
  const Instance nothing{};
  const Instance in_scene{.scene = build(std::span(&nothing, 1))};
  for (const Scene& scene : {Scene(), build(std::span(&nothing, 1)), build(std::span(&in_scene, 1))}) {
    const Bytes bytes = scene.save();
    const Scene again = Scene::load(bytes);
    EXPECT_EQ(again.instance_count(), scene.instance_count());
    EXPECT_TRUE(again.bounds().empty());
    EXPECT_EQ(again.save(), bytes);
  }
}

TEST(SceneFile, TheFileOfAHierarchyIsASceneOfOneInstance) {
  const Bvh bvh = build(workbench::make_torus(24, 12).mesh());
  const TemporaryDirectory directory;
  bvh.save(directory / "bvh.kerf");
  Bytes version_2 = kerf_tests::with_node_width(bvh, 16).save();
  const std::uint32_t version = 2, no_width = 0;
  std::memcpy(version_2.data() + offsetof(FileHeader, version), &version, sizeof version);
  std::memcpy(version_2.data() + offsetof(FileHeader, node_width), &no_width, sizeof no_width);
  forged::sign(version_2);
  for (const Scene& scene : {Scene::load(directory / "bvh.kerf"), Scene::map(directory / "bvh.kerf"),
                             Scene::load(bvh.save()), Scene::load(version_2)}) {
    ASSERT_EQ(scene.instances().size(), 1u);
    const Ray ray{.origin = {-3, 0.1f, 0.2f}, .direction = {1, 0, 0}};
    const auto hit = scene.intersect(ray);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->primitive, bvh.intersect(ray)->primitive);
    EXPECT_EQ(hit->t, bvh.intersect(ray)->t);
  }
  build(std::vector<Instance>{{.object = bvh}}).save(directory / "scene.kerf");
  for (const bool mapped : {false, true}) {
    EXPECT_EQ(
        error_of([&] { mapped ? Bvh::map(directory / "scene.kerf") : Bvh::load(directory / "scene.kerf"); }),
        std::pair(int{Error::bad_format},
                  (directory / "scene.kerf").string() +
                      ": the file holds a scene of instances, not one hierarchy: load it as a scene"));
  }
}

TEST(SceneFile, NodesOfAnotherWidthAreConvertedByLoadAndRefusedByMap) {
  std::mt19937 random(3);
  const Bvh bvh = build(workbench::make_torus(24, 12).mesh());
  const TemporaryDirectory directory;
  const std::uint32_t own_width = Structure::of(bvh).wide.width;
  for (const std::uint32_t width : {16u, 8u, 4u}) {
    const Scene scene = build(std::vector<Instance>{
        {.object = kerf_tests::with_node_width(bvh, width), .transform = any_transform(random, 1)}});
    scene.save(directory / "scene.kerf");
    const Scene expected =
        build(std::vector<Instance>{{.object = bvh, .transform = scene.instances()[0].transform}});
    expect_same_answers(Scene::load(directory / "scene.kerf"), expected, random);
    if (width != own_width) {
      const std::string refusal = error_of([&] { Scene::map(directory / "scene.kerf"); }).second;
      EXPECT_NE(refusal.find("hierarchy 0: the file has nodes of"), std::string::npos) << refusal;
    }
  }
}

// A scene of a scene and an object: small, but with something of everything.
Bytes small_file() {
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::uint32_t> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const Bvh bvh = build({.vertices = vertices, .triangles = indices});
  const Scene inner = build(std::vector<Instance>{
      {.object = bvh, .transform = {{{0, -1, 0, 0.5}, {1, 0, 0, 0}, {0, 0, 2, 0}}}, .number = 7}});
  const std::vector<Instance> instances{
      {.scene = inner}, {.object = bvh, .transform = {{{1, 0, 0, 3}, {0, 1, 0, 0}, {0, 0, 1, 0}}}}};
  return build(instances).save();
}

TEST(SceneFile, EveryTruncationAndEveryChangedByteIsRefused) {
  const Bytes file = small_file();
  for (std::size_t length = 0; length < file.size(); ++length) {
    ASSERT_EQ(error_of([&] { Scene::load(std::span(file).first(length)); }).first, Error::bad_format)
        << length;
  }
  Bytes changed = file;
  changed.push_back(std::byte{0});
  ASSERT_EQ(error_of([&] { Scene::load(changed); }).first, Error::bad_format);
  changed = file;
  for (std::size_t i = 0; i < file.size(); ++i) {
    for (int change = 1; change < 256; change += 1 + static_cast<int>(test::slowdown / 4)) {
      changed[i] = file[i] ^ static_cast<std::byte>(change);
      ASSERT_EQ(error_of([&] { Scene::load(changed); }).first, Error::bad_format)
          << "byte " << i << " changed by " << change;
    }
    changed[i] = file[i];
  }
}

TEST(SceneFile, EveryForgedByteOfASmallFileIsRefusedOrAnswers) {
  const Bytes file = small_file();
  std::size_t shown = 0, refused = 0;
  for (std::size_t i = 0; i < file.size(); ++i) {
    for (const int change : {1, 4, 0x40, 0x80, 0xff}) {
      Bytes changed = file;
      changed[i] ^= static_cast<std::byte>(change);
      forged::sign_scene(changed);
      ++shown;
      try {
        forged::query(Scene::load(changed));
      } catch (const Error& error) {
        ASSERT_EQ(error.code(), Error::bad_format) << i << ' ' << change << ' ' << error.what();
        ++refused;
      }
    }
  }
  EXPECT_LT(refused, shown);  // coordinates and transforms may be changed at will,
  EXPECT_GT(refused, 0u);     // numbers of hierarchies may not
}

TEST(SceneFile, WhatIsForgedIsNamed) {
  const Bytes file = small_file();
  SceneFileHeader header;
  std::memcpy(&header, file.data(), sizeof header);
  const SceneLayout layout(header);
  ASSERT_EQ(header.objects, 1u);
  ASSERT_EQ(header.scenes, 2u);
  ASSERT_EQ(header.instances, 3u);
  const auto forged = [&](std::size_t at, auto value) {
    Bytes changed = file;
    std::memcpy(changed.data() + at, &value, sizeof value);
    forged::sign_scene(changed);
    return sentence(changed);
  };
  const std::size_t counts = layout.tables_at + 8, instances = counts + 16;
  EXPECT_EQ(forged(offsetof(SceneFileHeader, kind), std::uint32_t{2}),
            "the file holds something that this kerf does not know (kind 2)");
  EXPECT_EQ(forged(offsetof(SceneFileHeader, zero), std::uint32_t{1}),
            "the header has something where a zero belongs");
  for (const std::size_t at : {offsetof(SceneFileHeader, scenes), offsetof(SceneFileHeader, objects)})
    EXPECT_EQ(forged(at, ~std::uint32_t{0}), "the header names impossible sizes");
  EXPECT_EQ(forged(offsetof(SceneFileHeader, scenes), std::uint32_t{0}), "the header names impossible sizes");
  EXPECT_EQ(forged(offsetof(SceneFileHeader, instances), ~std::uint64_t{0}),
            "the header names impossible sizes");
  EXPECT_EQ(forged(offsetof(SceneFileHeader, file_bytes), std::uint64_t{64}),
            "the header names impossible sizes");
  EXPECT_EQ(forged(layout.tables_at, std::uint64_t{65}), "hierarchy 0 has an impossible length");
  EXPECT_EQ(forged(layout.tables_at, ~std::uint64_t{63}), "hierarchy 0 has an impossible length");
  EXPECT_EQ(forged(layout.tables_at, std::uint64_t{64}), "the lengths of the hierarchies do not add up");
  EXPECT_EQ(forged(counts, std::uint64_t{4}), "scene 0 has more instances than there are");
  EXPECT_EQ(forged(counts + 8, std::uint64_t{1}), "instances of no scene (2)");
  EXPECT_EQ(forged(instances + offsetof(FileInstance, what), std::uint32_t{1}),
            "an instance of what the file does not hold before it (0)");
  // A scene in itself, and one in one behind it.
  EXPECT_EQ(forged(instances + offsetof(FileInstance, what), FileInstance::scene_bit),
            "an instance of what the file does not hold before it (0)");
  EXPECT_EQ(forged(instances + 112 + offsetof(FileInstance, what), FileInstance::scene_bit | 1u),
            "an instance of what the file does not hold before it (1)");
  EXPECT_EQ(forged(instances + 112 + offsetof(FileInstance, zero), std::uint32_t{1}),
            "an instance with something where a zero belongs (1)");
  EXPECT_EQ(forged(instances, std::numeric_limits<double>::infinity()),
            "scene 0: the transform of instance 0 has a number that is not finite");
  EXPECT_EQ(forged(static_cast<std::size_t>(layout.objects_at) - 1, std::byte{1}),
            "the file is damaged between its sections");
  EXPECT_EQ(forged(static_cast<std::size_t>(layout.objects_at) + offsetof(FileHeader, nodes),
                   std::uint32_t{1} << 27),
            "hierarchy 0: the sizes in the header do not add up");
  Bytes damaged = file;
  damaged[instances] ^= std::byte{1};
  EXPECT_EQ(sentence(damaged), "the list of instances is damaged: wrong checksum");
}

TEST(SceneFile, WhatCannotBeReadIsNamed) {
  const TemporaryDirectory directory;
  write_bytes(directory / "text.kerf", "v 0 0 0\n");
  EXPECT_EQ(
      error_of([&] { Scene::load(directory / "text.kerf"); }),
      std::pair(int{Error::bad_format}, (directory / "text.kerf").string() + ": this is not a .kerf file"));
  EXPECT_EQ(error_of([&] { Scene::map(directory / "none.kerf"); }).first, Error::io);
  EXPECT_EQ(error_of([&] { Scene().save(directory / "no/such/place.kerf"); }).first, Error::io);
}

}  // namespace
}  // namespace kerf
